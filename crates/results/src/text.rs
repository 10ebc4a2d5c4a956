//! Results as text.

use serde::Serialize;
use serde_json::Value;

/// A result as JSON: objects over several lines, lists of numbers and words on one.
pub fn text(result: &impl Serialize) -> String {
    let mut text = String::new();
    // A result is text, numbers and names of fields: it can always be written.
    write(
        &serde_json::to_value(result).unwrap_or_default(),
        0,
        &mut text,
    );
    text
}

fn write(value: &Value, depth: usize, text: &mut String) {
    let line = |text: &mut String, depth: usize| {
        text.push('\n');
        (0..depth).for_each(|_| text.push_str("  "));
    };
    let nested = |value: &Value| value.is_object() || value.is_array();
    match value {
        Value::Object(map) if !map.is_empty() => {
            text.push('{');
            for (k, (key, value)) in map.iter().enumerate() {
                if k > 0 {
                    text.push(',');
                }
                line(text, depth + 1);
                text.push_str(&Value::from(key.as_str()).to_string());
                text.push_str(": ");
                write(value, depth + 1, text);
            }
            line(text, depth);
            text.push('}');
        }
        Value::Array(list) if list.iter().any(nested) => {
            text.push('[');
            for (k, value) in list.iter().enumerate() {
                if k > 0 {
                    text.push(',');
                }
                line(text, depth + 1);
                write(value, depth + 1, text);
            }
            line(text, depth);
            text.push(']');
        }
        flat => text.push_str(&flat.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn text_is_read_back_as_it_was() {
        let value = json!({
            "a": [1.5, null, 1e-300, "two\n\"words\""], "b": {}, "c": [{"d": []}, [0.1, -2]],
            "e\"f": {"g": true},
        });
        let text = text(&value);
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
        assert!(text.contains("\n  \"a\": [1.5,null,"), "{text}");
    }
}
