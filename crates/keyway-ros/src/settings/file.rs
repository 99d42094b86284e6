//! Parameter files: node names, with or without namespaces, and their parameters.

use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use toml::{Table, Value};

/// Maximum size of a parameter file \[B\].
const LONGEST_B: u64 = 1 << 20;

/// The top-level names of a file with their content, or an error message.
pub(super) fn read(path: &Path) -> Result<Table, String> {
    let mut text = Vec::new();
    let file = File::open(path).map_err(|error| error.to_string())?;
    file.take(LONGEST_B + 1).read_to_end(&mut text).map_err(|error| error.to_string())?;
    if text.len() as u64 > LONGEST_B {
        return Err("it is larger than 1 MiB, so it is not a parameter file".to_owned());
    }
    let text = String::from_utf8(text).map_err(|_| "it is not UTF-8 text".to_owned())?;
    let fault = |error: serde_saphyr::Error| {
        let said = error.to_string();
        said.strip_prefix("error: ").unwrap_or(&said).to_owned()
    };
    match serde_saphyr::from_str(&text).map_err(fault)? {
        Item(Some(Value::Table(nodes))) => Ok(nodes),
        // A file with only comments is empty.
        Item(None) => Ok(Table::new()),
        Item(Some(_)) => Err("node names are missing at the top level".to_owned()),
    }
}

/// The nodes of a file with their parameters. Namespaces above the nodes become part of their
/// names.
pub(super) fn nodes(file: &Table) -> Vec<(String, &Table)> {
    let mut nodes = Vec::new();
    for (name, inner) in file {
        let Value::Table(inner) = inner else { continue };
        if let Some(Value::Table(parameters)) = inner.get("ros__parameters") {
            nodes.push((name.clone(), parameters));
        }
        nodes.extend(self::nodes(inner).into_iter().filter_map(|(node, parameters)| {
            // Parameters that are tables are not nodes.
            (name != "ros__parameters").then(|| {
                let node = node.strip_prefix('/').unwrap_or(&node);
                (format!("{}/{node}", name.trim_end_matches('/')), parameters)
            })
        }));
    }
    nodes
}

/// A YAML value. Null is treated as absent.
struct Item(Option<Value>);

impl<'de> Deserialize<'de> for Item {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Anything)
    }
}

struct Anything;

impl<'de> Visitor<'de> for Anything {
    type Value = Item;

    fn expecting(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str("a boolean, a number, a string, a list or names with values")
    }

    fn visit_unit<E: Error>(self) -> Result<Item, E> {
        Ok(Item(None))
    }

    fn visit_bool<E: Error>(self, truth: bool) -> Result<Item, E> {
        Ok(Item(Some(Value::Boolean(truth))))
    }

    fn visit_i64<E: Error>(self, whole: i64) -> Result<Item, E> {
        Ok(Item(Some(Value::Integer(whole))))
    }

    fn visit_u64<E: Error>(self, whole: u64) -> Result<Item, E> {
        let whole = i64::try_from(whole).map(Value::Integer);
        Ok(Item(Some(whole.map_err(|_| E::custom("the number is too large"))?)))
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Item, E> {
        Ok(Item(Some(Value::Float(number))))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Item, E> {
        Ok(Item(Some(Value::String(text.to_owned()))))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Item, A::Error> {
        let mut items = Vec::new();
        while let Some(Item(item)) = list.next_element()? {
            items.push(item.ok_or_else(|| A::Error::custom("an item of a list is empty"))?);
        }
        Ok(Item(Some(Value::Array(items))))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Item, A::Error> {
        let mut table = Table::new();
        while let Some((name, Item(item))) = map.next_entry::<String, _>()? {
            if let Some(item) = item {
                table.insert(name, item);
            }
        }
        Ok(Item(Some(Value::Table(table))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<Table, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read(file.path())
    }

    #[test]
    fn namespaces_stand_above_nodes() {
        let text = "/r1:\n  keyway:\n    ros__parameters: {a: 1, b: {ros__parameters: {c: 2}}}\n\
                    /**:\n  ros__parameters: {d: 3}\n  keyway:\n    ros__parameters: {e: 4}\n";
        let file = read_text(text).unwrap();
        let names: Vec<String> = nodes(&file).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["/r1/keyway", "/**", "/**/keyway"]);
    }

    #[test]
    fn what_is_empty_is_not_given() {
        let text = "keyway:\n  ros__parameters:\n    a:\n    b: 1\nother:\n  ros__parameters:\n";
        let file = read_text(text).unwrap();
        let [(name, parameters)] = &nodes(&file)[..] else { panic!("one has parameters") };
        assert_eq!((name.as_str(), parameters.len()), ("keyway", 1));
        assert_eq!(parameters["b"].as_integer(), Some(1));
        assert!(read_text("# nothing\n").unwrap().is_empty());
    }

    #[test]
    fn what_is_no_file_of_parameters_is_refused() {
        for (text, said) in [
            ("- 1\n", "node names"),
            ("a: [1, ]\nb: [1, ~]\n", "empty"),
            ("a: 18446744073709551615\n", "too large"),
            ("a: [\n", "line"),
        ] {
            let fault = read_text(text).unwrap_err();
            assert!(fault.contains(said), "{fault}");
        }
        let endless = read(Path::new("/dev/zero")).unwrap_err();
        assert!(endless.contains("larger than 1 MiB"), "{endless}");
        assert!(read(Path::new("/")).is_err());
    }
}
