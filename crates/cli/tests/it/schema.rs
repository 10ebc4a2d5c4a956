//! Results against their published JSON Schema.

use serde_json::{Map, Value};
use std::path::Path;
use undrift::results::text;

/// Panics unless a result, as a verb wrote it, is what docs/schema says and is read back as it was.
pub fn conforms(result: &str) {
    let root: Value =
        serde_json::from_str(include_str!("../../../../docs/schema/results.schema.json")).unwrap();
    let value: Value = serde_json::from_str(result).unwrap();
    // The union of all kinds would only say that none fits.
    let kinds = root["anyOf"].as_array().unwrap();
    let kind = kinds.iter().map(|kind| resolved(kind, &root));
    let kind = kind.filter(|kind| kind["properties"]["kind"]["const"] == value["kind"]);
    let [kind] = kind.collect::<Vec<_>>()[..] else {
        panic!("the schema does not have one kind {}", value["kind"]);
    };
    let mut problems = Vec::new();
    check(kind, &root, &value, "", &mut problems);
    assert!(problems.is_empty(), "{}: {problems:#?}", value["kind"]);
    let read = undrift_report::read(Path::new("result.json"), result).unwrap();
    assert!(
        text(&read) == result.trim_end(),
        "{} reads differently",
        value["kind"]
    );
}

/// What verbs write beside results is one of the schema's other shapes.
#[test]
fn what_is_no_result_conforms_too() {
    let here = std::env::temp_dir().join(format!("undrift-schema-{}", std::process::id()));
    std::fs::create_dir_all(&here).unwrap();
    std::fs::write(here.join("imu.csv"), "time,gx,gy\n0,1,2\n1,1,2\n").unwrap();
    let fleet = undrift::results::Fleet::default();
    std::fs::write(here.join("fleet.json"), text(&fleet)).unwrap();
    let root: Value =
        serde_json::from_str(include_str!("../../../../docs/schema/results.schema.json")).unwrap();
    for arguments in [
        &["inspect", "imu.csv", "--json", "-"][..],
        &["report", "fleet.json", "-o", "a.html", "--json", "-"],
    ] {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_undrift"));
        let output = command.args(arguments).current_dir(&here).output().unwrap();
        let value: Value = serde_json::from_slice(&output.stdout).unwrap();
        let problems = root["anyOf"].as_array().unwrap().iter().map(|shape| {
            let mut problems = Vec::new();
            check(shape, &root, &value, "", &mut problems);
            problems
        });
        let problems: Vec<_> = problems.collect();
        assert!(problems.iter().any(Vec::is_empty), "{problems:#?}");
    }
    std::fs::remove_dir_all(&here).unwrap();
}

fn resolved<'a>(schema: &'a Value, root: &'a Value) -> &'a Value {
    match schema["$ref"].as_str() {
        Some(path) => resolved(root.pointer(path.strip_prefix('#').unwrap()).unwrap(), root),
        None => schema,
    }
}

/// What JSON Schema 2020-12 says against a value, as far as its keywords occur in our schemas; and keys that the
/// schema does not know.
fn check(schema: &Value, root: &Value, value: &Value, path: &str, problems: &mut Vec<String>) {
    let schema = resolved(schema, root);
    let Some(keywords) = schema.as_object() else {
        return;
    };
    let mut say = |problem: String| problems.push(format!("{path}: {problem}"));
    let types: Vec<&str> = match &schema["type"] {
        Value::Array(types) => types.iter().filter_map(Value::as_str).collect(),
        one => one.as_str().into_iter().collect(),
    };
    if !types.is_empty() && !types.iter().any(|name| is_of(name, value)) {
        say(format!("{value} is no {types:?}"));
    }
    if keywords.get("const").is_some_and(|only| only != value) {
        say(format!("{value} is not {}", schema["const"]));
    }
    if schema["enum"]
        .as_array()
        .is_some_and(|all| !all.contains(value))
    {
        say(format!("{value} is not one of {}", schema["enum"]));
    }
    for keyword in ["anyOf", "oneOf"] {
        let Some(all) = schema[keyword].as_array() else {
            continue;
        };
        let fits = |one: &&Value| {
            let mut against = Vec::new();
            check_open(one, root, value, &mut against);
            against.is_empty()
        };
        if !all.iter().any(|one| fits(&one)) {
            problems.push(format!("{path}: {value} fits none of {keyword}"));
        }
    }
    if let Some(object) = value.as_object() {
        let mut known = Map::new();
        keys(schema, root, value, &mut known);
        for required in schema["required"].as_array().into_iter().flatten() {
            if !object.contains_key(required.as_str().unwrap()) {
                problems.push(format!("{path}: {required} is missing"));
            }
        }
        for (key, value) in object {
            let below = format!("{path}.{key}");
            match (known.get(key), keywords.get("additionalProperties")) {
                (Some(schema), _) | (None, Some(schema)) => {
                    check(schema, root, value, &below, problems)
                }
                (None, None) => problems.push(format!("{below}: unknown key")),
            }
        }
    }
    if let Some(list) = value.as_array() {
        let first = schema["prefixItems"]
            .as_array()
            .map_or(&[][..], Vec::as_slice);
        for (at, value) in list.iter().enumerate() {
            let item = first.get(at).or(keywords.get("items"));
            let below = format!("{path}[{at}]");
            check(item.unwrap_or(&Value::Null), root, value, &below, problems);
        }
        let most = schema["maxItems"].as_u64().unwrap_or(u64::MAX);
        if !(schema["minItems"].as_u64().unwrap_or(0)..=most).contains(&(list.len() as u64)) {
            problems.push(format!("{path}: {} items", list.len()));
        }
    }
}

/// One alternative: keys of the others may stand beside its own.
fn check_open(schema: &Value, root: &Value, value: &Value, problems: &mut Vec<String>) {
    let mut all = Vec::new();
    check(schema, root, value, "", &mut all);
    problems.extend(
        all.into_iter()
            .filter(|problem| !problem.ends_with("unknown key")),
    );
}

/// The keys that a schema knows of a value, with their schemas; of alternatives, those that the value fits.
fn keys(schema: &Value, root: &Value, value: &Value, known: &mut Map<String, Value>) {
    let schema = resolved(schema, root);
    if let Some(properties) = schema["properties"].as_object() {
        known.extend(properties.clone());
    }
    for one in schema["allOf"].as_array().into_iter().flatten() {
        keys(one, root, value, known);
    }
    for keyword in ["anyOf", "oneOf"] {
        for one in schema[keyword].as_array().into_iter().flatten() {
            let mut against = Vec::new();
            check_open(one, root, value, &mut against);
            if against.is_empty() {
                keys(one, root, value, known);
            }
        }
    }
}

fn is_of(name: &str, value: &Value) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "integer" => value.is_u64() || value.is_i64(),
        _ => value.is_number(),
    }
}
