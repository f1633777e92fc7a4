//! Leaves nodes out of a bake by name.

use crate::model::Scene;

impl Scene {
    /// Marks nodes whose name matches one of the globs as [`dynamic`](crate::Node::dynamic).
    ///
    /// In a glob, `*` stands for any run of characters and `?` for one; case matters. Returns how many nodes each glob
    /// matched, in the order given.
    pub fn exclude(&mut self, globs: &[String]) -> Vec<usize> {
        globs
            .iter()
            .map(|glob| {
                let matching = self.nodes.iter_mut().filter(|node| glob_matches(glob, &node.name));
                matching.map(|node| node.dynamic = true).count()
            })
            .collect()
    }
}

/// Whether all of `text` matches `glob`. Takes at most the product of their lengths.
#[must_use]
pub fn glob_matches(glob: &str, text: &str) -> bool {
    let (glob, text): (Vec<char>, Vec<char>) = (glob.chars().collect(), text.chars().collect());
    let (mut g, mut t) = (0, 0);
    // After the last star: where to go on in the glob, and how much of the text the star has swallowed.
    let mut star: Option<(usize, usize)> = None;
    while t < text.len() {
        match glob.get(g) {
            Some('*') => {
                star = Some((g + 1, t));
                g += 1;
            }
            Some(&c) if c == '?' || c == text[t] => {
                g += 1;
                t += 1;
            }
            _ => {
                let Some((after, swallowed)) = star else { return false };
                star = Some((after, swallowed + 1));
                (g, t) = (after, swallowed + 1);
            }
        }
    }
    glob[g..].iter().all(|&c| c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Node;

    #[test]
    fn globs() {
        for (glob, text) in [
            ("", ""),
            ("*", ""),
            ("*", "door"),
            ("door*", "door.001"),
            ("*door", "frontdoor"),
            ("d??r", "door"),
            ("*a*b*", "xxaxxbxx"),
            ("a*b*c", "a-b-b-c"),
            ("?", "é"),
            ("**", "x"),
        ] {
            assert!(glob_matches(glob, text), "{glob} {text}");
        }
        for (glob, text) in [("", "x"), ("?", ""), ("door", "Door"), ("door", "doors"), ("a*b", "a-c"), ("*?", "")] {
            assert!(!glob_matches(glob, text), "{glob} {text}");
        }
    }

    #[test]
    fn exclude_marks_and_counts() {
        let node = |name: &str| Node {
            name: name.to_owned(),
            mesh: 0,
            world_from_mesh: glam::DAffine3::IDENTITY,
            dynamic: false,
        };
        let mut scene = Scene { nodes: ["door.1", "door.2", "wall"].map(node).to_vec(), ..Scene::default() };
        assert_eq!(scene.exclude(&["door*".to_owned(), "*.2".to_owned(), "gate".to_owned()]), [2, 1, 0]);
        assert_eq!(scene.nodes.iter().map(|n| n.dynamic).collect::<Vec<_>>(), [true, true, false]);
    }
}
