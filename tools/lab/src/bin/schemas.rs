//! Writes docs/schema: JSON Schemas of what is written and read, for editors and other programs.

use schemars::{Schema, generate::SchemaSettings};
use std::path::PathBuf;
use undrift::{
    inspect::Inspection,
    results::{ReportFiles, Results},
};

/// The schemas by their files.
fn schemas() -> Vec<(PathBuf, String)> {
    let written = SchemaSettings::draft2020_12().for_serialize();
    let mut generator = written.into_generator();
    let others = [
        generator.subschema_for::<Vec<Inspection>>(),
        generator.subschema_for::<ReportFiles>(),
    ];
    let mut results: Schema = generator.into_root_schema_for::<Results>();
    add_kinds(&mut results);
    add_sentences(&mut results);
    if let Some(all) = results
        .pointer_mut("/anyOf")
        .and_then(|all| all.as_array_mut())
    {
        all.extend(others.map(Schema::to_value));
    }
    [("results", results)]
        .into_iter()
        .map(|(name, schema)| {
            let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema"));
            // Rustdoc needs the brackets of units escaped, a schema's reader does not.
            let text = format!("{:#}\n", schema.as_value());
            let text = text.replace(r"\\[", "[").replace(r"\\]", "]");
            (folder.join(format!("{name}.schema.json")), text)
        })
        .collect()
}

/// Each result names its kind, which the derived schema leaves out: the tag of a struct.
fn add_kinds(results: &mut Schema) {
    let kinds = results.get("anyOf").and_then(|all| all.as_array()).cloned();
    for kind in kinds.unwrap_or_default() {
        let Some(path) = kind["$ref"].as_str() else {
            continue;
        };
        let name = path.rsplit('/').next().unwrap_or_default();
        let Some(schema) = results.pointer_mut(path.trim_start_matches('#')) else {
            continue;
        };
        schema["properties"]["kind"] = serde_json::json!({ "type": "string", "const": name });
        if let Some(required) = schema["required"].as_array_mut() {
            required.push("kind".into());
        }
    }
}

/// Sentences that the report writes beside the values that an inspection has.
fn add_sentences(results: &mut Schema) {
    let one = serde_json::json!({ "type": "string" });
    let several = serde_json::json!({ "type": "array", "items": one });
    let sentences = "The same in sentences.";
    let words = "The same in words, empty where it is certain.";
    for (property, what, mut schema) in [
        ("Inspection/notes", sentences, several.clone()),
        ("Measured/remarks", sentences, several),
        ("InspectedLine/why", words, one),
    ] {
        schema["description"] = what.into();
        let (name, key) = property.split_once('/').unwrap_or_default();
        if let Some(of) = results.pointer_mut(&format!("/$defs/{name}")) {
            of["properties"][key] = schema;
            if let Some(required) = of["required"].as_array_mut() {
                required.push(key.into());
            }
        }
    }
}

fn main() -> std::io::Result<()> {
    schemas()
        .into_iter()
        .try_for_each(|(path, text)| std::fs::write(path, text))
}

#[test]
fn what_is_published_is_up_to_date() {
    for (path, text) in schemas() {
        let published = std::fs::read_to_string(&path).unwrap_or_default();
        let path = path.display();
        assert!(
            published == text,
            "{path}: run cargo run -p undrift-lab --bin schemas"
        );
    }
}
