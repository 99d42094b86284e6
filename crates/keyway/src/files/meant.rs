//! Suggestions for misspelt names.

/// A suggestion to end an error message with that refuses a name: `; did you mean ...?` with the
/// nearest of the existing names. Empty if none is near. Case and hyphens do not count, and `*` is
/// read as `star`.
///
/// ```
/// use keyway::files::did_you_mean;
/// assert_eq!(did_you_mean("Jakcal", ["small", "jackal"]), "; did you mean `jackal`?");
/// assert_eq!(did_you_mean("A*", ["dijkstra", "astar"]), "; did you mean `astar`?");
/// assert_eq!(did_you_mean("hal", ["small", "jackal"]), "");
/// ```
pub fn did_you_mean<'a>(given: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let bare = |name: &str| name.to_lowercase().replace('*', "star").replace(['-', '_', ' '], "");
    let given = bare(given);
    // A third of the letters may be wrong.
    let most = given.chars().count() / 3;
    let distance = |name: &str| strsim::osa_distance(&given, &bare(name));
    let names: Vec<&str> = names.into_iter().collect();
    // `s0` is the beginning of `s0-key-point`.
    let begins = |name: &str| name.to_lowercase().starts_with(&format!("{given}-"));
    let begun = names.iter().copied().find(|name| !given.is_empty() && begins(name));
    let near = names.iter().copied().map(|name| (distance(name), name));
    let nearest = near.filter(|(wrong, _)| *wrong <= most).min_by_key(|(wrong, _)| *wrong);
    let nearest = nearest.or_else(|| begun.map(|name| (0, name)));
    nearest.map_or_else(String::new, |(_, name)| format!("; did you mean `{name}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_meant_if_it_is_near() {
        let names = ["jps", "astar", "astar4", "theta-star", "lazy-theta-star"];
        let meant = |given: &str| did_you_mean(given, names);
        assert_eq!(meant("jsp"), "; did you mean `jps`?");
        assert_eq!(meant("astar5"), "; did you mean `astar`?", "of equals the first");
        assert_eq!(meant("THETA_STAR"), "; did you mean `theta-star`?");
        assert_eq!(meant("lazy"), "; did you mean `lazy-theta-star`?");
        assert_eq!(meant("A*"), "; did you mean `astar`?");
        assert_eq!(meant("lazy theta*"), "; did you mean `lazy-theta-star`?");
        assert_eq!(["", "a", "rrt", "dijkstra"].map(meant), [""; 4]);
        assert_eq!(did_you_mean("jps", []), "");
    }
}
