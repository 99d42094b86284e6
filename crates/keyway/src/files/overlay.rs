//! Changes applied to a value: from a file, or one by one.

use super::{did_you_mean, in_plain_words};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::marker::PhantomData;
use thiserror::Error;
use toml::{Table, Value};

/// The key that selects one of several alternatives in a table.
const NAME: &str = "name";

/// The default of a named alternative: maps the path of a table and a name to the table, or to the
/// names that exist.
pub type NamedDefault<'a> = &'a dyn Fn(&str, &str) -> Result<Table, Vec<&'static str>>;

/// A value of type `T` as a tree. Its fields can be changed by their path, such as
/// `limits.v_max_mps`, or `sensors[0].range_m` in an item of a list.
///
/// A change may only replace an existing value, or set an optional field that has none. Every
/// change is tried at once, so that an error names its field. A table with a `name` is one of
/// several alternatives: a change of its name replaces the whole table by the default of the new
/// name.
pub struct Overlay<'a, T> {
    tree: Table,
    named: NamedDefault<'a>,
    kind: PhantomData<T>,
}

/// A change that cannot be made.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum OverlayError {
    /// No field has this path.
    #[error(
        "there is no field `{path}`; {}{}",
        beside_text(parent, names),
        field_meant(path, names)
    )]
    Unknown {
        /// The path.
        path: String,
        /// The table that would contain it; empty for the root.
        parent: String,
        /// The fields of that table.
        names: Vec<String>,
    },
    /// No alternative has this name.
    #[error(
        "`{path}` must be one of {}, got `{got}`{}", names.join(", "),
        did_you_mean(got, names.iter().copied())
    )]
    Name {
        /// The field.
        path: String,
        /// The names that exist.
        names: Vec<&'static str>,
        /// The name that was given.
        got: String,
    },
    /// The value is invalid for this field.
    #[error("`{path}`: {reason}")]
    Rejected {
        /// The field.
        path: String,
        /// Reason for the rejection.
        reason: String,
    },
}

impl OverlayError {
    /// Path of the offending field.
    pub fn path(&self) -> &str {
        match self {
            Self::Unknown { path, .. } | Self::Name { path, .. } | Self::Rejected { path, .. } => {
                path
            }
        }
    }
}

fn beside_text(parent: &str, names: &[String]) -> String {
    let names = names.join(", ");
    if parent.is_empty() {
        format!("the fields are: {names}")
    } else {
        format!("`{parent}` has: {names}")
    }
}

/// Suggests a field of a table for a path to a field that does not exist.
fn field_meant(path: &str, names: &[String]) -> String {
    let given = path.rsplit('.').next().unwrap_or(path);
    did_you_mean(given, names.iter().map(String::as_str))
}

impl<'a, T: Serialize + DeserializeOwned> Overlay<'a, T> {
    /// The tree of a value.
    ///
    /// # Errors
    /// Returns [`OverlayError`] if the value cannot be written as TOML.
    pub fn of(value: &T, named: NamedDefault<'a>) -> Result<Self, OverlayError> {
        let tree = Table::try_from(value).map_err(|error| rejected("", &error.to_string()))?;
        Ok(Self { tree, named, kind: PhantomData })
    }

    /// Applies a tree of changes: names first, because they determine the fields.
    ///
    /// # Errors
    /// Names the first field that cannot be changed like this.
    pub fn merge(&mut self, changes: &Table) -> Result<(), OverlayError> {
        self.merge_at("", changes)
    }

    fn merge_at(&mut self, path: &str, changes: &Table) -> Result<(), OverlayError> {
        let (names, fields): (Vec<_>, Vec<_>) = changes.iter().partition(|(key, _)| *key == NAME);
        for (key, value) in names.into_iter().chain(fields) {
            self.set(&joined(path, key), value.clone())?;
        }
        Ok(())
    }

    /// Changes one field, or all the fields that a table gives.
    ///
    /// # Errors
    /// Names the field that cannot be changed like this.
    pub fn set(&mut self, path: &str, value: Value) -> Result<(), OverlayError> {
        let (parent_path, key) = path.rsplit_once('.').unwrap_or(("", path));
        if let Err(OverlayError::Unknown { path: absent, .. }) =
            table_at(&mut self.tree, parent_path)
        {
            // A table without a value is set as a whole.
            let below = path[absent.len() + 1..].rsplit('.');
            let whole = below.fold(value, |inner, key| {
                Value::Table(Table::from_iter([(key.to_owned(), inner)]))
            });
            let (above, key) = absent.rsplit_once('.').unwrap_or(("", &absent));
            return self.add(&absent, above, key, whole);
        }
        let parent = table_at(&mut self.tree, parent_path)?;
        match (parent.get(key), value) {
            (None, value) => return self.add(path, parent_path, key, value),
            (Some(Value::Table(_)), Value::Table(changes)) => return self.merge_at(path, &changes),
            (Some(Value::String(name)), Value::String(wanted)) if key == NAME => {
                if *name != wanted {
                    self.rename(path, parent_path, &wanted)?;
                }
            }
            (Some(_), value) => {
                parent.insert(key.to_owned(), value);
            }
        }
        self.value().map(drop).map_err(|reason| rejected(path, &reason))
    }

    /// Adds an absent field, which may be an optional one without a value: those are left out.
    fn add(
        &mut self,
        path: &str,
        parent_path: &str,
        key: &str,
        value: Value,
    ) -> Result<(), OverlayError> {
        let mut tree = self.tree.clone();
        table_at(&mut tree, parent_path)?.insert(key.to_owned(), value);
        match T::deserialize(Value::Table(tree)) {
            Ok(value) => {
                let mut tree = Table::try_from(&value).unwrap_or_default();
                let is_known =
                    table_at(&mut tree, parent_path).is_ok_and(|table| table.contains_key(key));
                if is_known {
                    self.tree = tree;
                    return Ok(());
                }
            }
            Err(error) if !error.message().starts_with("unknown field") => {
                return Err(rejected(path, &in_plain_words(error.message())));
            }
            Err(_) => {}
        }
        Err(unknown(path, parent_path, table_at(&mut self.tree, parent_path)?))
    }

    fn rename(&mut self, path: &str, parent_path: &str, name: &str) -> Result<(), OverlayError> {
        let default = (self.named)(parent_path, name).map_err(|names| OverlayError::Name {
            path: path.to_owned(),
            names,
            got: name.to_owned(),
        })?;
        *table_at(&mut self.tree, parent_path)? = default;
        Ok(())
    }

    fn value(&self) -> Result<T, String> {
        let tree = Value::Table(self.tree.clone());
        T::deserialize(tree).map_err(|error: toml::de::Error| in_plain_words(error.message()))
    }

    /// The alternative that the table of a key holds.
    pub fn name_at(&self, key: &str) -> Option<&str> {
        self.tree.get(key)?.get(NAME)?.as_str()
    }

    /// The changed value.
    ///
    /// # Errors
    /// Returns [`OverlayError`] if the whole is invalid although every single change was accepted.
    pub fn finish(self) -> Result<T, OverlayError> {
        self.value().map_err(|reason| rejected("", &reason))
    }
}

/// The value of a text on the command line: TOML if it parses as such, otherwise the text itself.
pub fn value_from_text(text: &str) -> Value {
    let table = format!("value = {text}").parse::<Table>().unwrap_or_default();
    let is_one = table.len() == 1;
    let value = table.into_iter().next().filter(|_| is_one);
    value.map_or_else(|| Value::String(text.to_owned()), |(_, value)| value)
}

fn table_at<'t>(tree: &'t mut Table, path: &str) -> Result<&'t mut Table, OverlayError> {
    let mut table = tree;
    let mut walked = String::new();
    for key in path.split('.').filter(|_| !path.is_empty()) {
        let here = joined(&walked, key);
        let (name, index) = item(key);
        if !table.contains_key(name) {
            return Err(unknown(&here, &walked, table));
        }
        table = match (table.get_mut(name), index) {
            (Some(Value::Table(inner)), None) => inner,
            (Some(Value::Array(items)), Some(index)) => {
                let count = items.len();
                match items.get_mut(index) {
                    Some(Value::Table(inner)) => inner,
                    Some(_) => return Err(rejected(&here, "has no fields of its own")),
                    None => {
                        return Err(rejected(
                            &here,
                            &format!("the list has {count} items, numbered from 0"),
                        ));
                    }
                }
            }
            (Some(Value::Array(_)), None) => {
                return Err(rejected(
                    &here,
                    &format!("is a list; give an index, such as `{here}[0]`"),
                ));
            }
            (Some(Value::Table(_)), Some(_)) => return Err(rejected(&here, "is not a list")),
            _ => return Err(rejected(&here, "has no fields of its own")),
        };
        walked = here;
    }
    Ok(table)
}

/// A key, and the index of its item, as in `sensors[0]`.
fn item(key: &str) -> (&str, Option<usize>) {
    let parts = key.strip_suffix(']').and_then(|key| key.split_once('['));
    let numbered = parts.and_then(|(name, index)| Some((name, index.parse().ok()?)));
    numbered.map_or((key, None), |(name, index)| (name, Some(index)))
}

fn joined(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

fn unknown(path: &str, parent: &str, table: &Table) -> OverlayError {
    let names = table.keys().cloned().collect();
    OverlayError::Unknown { path: path.to_owned(), parent: parent.to_owned(), names }
}

fn rejected(path: &str, reason: &str) -> OverlayError {
    OverlayError::Rejected { path: path.to_owned(), reason: reason.to_owned() }
}

#[cfg(test)]
#[path = "overlay_tests.rs"]
mod tests;
