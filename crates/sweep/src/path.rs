//! Names of columns: keys that lead through a scene file, as TOML writes dotted keys.

use std::fmt::Write;

/// Keys, from the root of the file on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Path(Vec<String>);

impl Path {
    /// Reads keys between dots; one in quotes `"` may hold dots.
    ///
    /// # Errors
    /// A key that is empty; a quote without its partner.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut keys = Vec::new();
        let mut rest = text.trim();
        loop {
            let (key, after) = match rest.strip_prefix('"') {
                Some(quoted) => quoted.split_once('"').ok_or("a quote has no partner")?,
                None => rest.split_at(rest.find('.').unwrap_or(rest.len())),
            };
            if key.is_empty() {
                return Err(
                    "a key is empty: keys stand between dots, such as `body.arm.mass`".into(),
                );
            }
            keys.push(key.to_owned());
            match after.strip_prefix('.') {
                Some(next) => rest = next,
                None if after.is_empty() => return Ok(Self(keys)),
                None => return Err("a dot is missing after a quoted key".into()),
            }
        }
    }

    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }
}

/// Appends a key to a path, as columns write it.
pub(crate) fn shown(key: &str, path: &mut String) {
    if !path.is_empty() {
        path.push('.');
    }
    let key = hamel::scene::text::visible_line(key);
    // A string takes all that is written.
    let _ = match key.contains('.') {
        true => write!(path, "\"{key}\""),
        false => write!(path, "{key}"),
    };
}

#[cfg(test)]
mod tests {
    use super::Path;

    #[test]
    fn keys_stand_between_dots() {
        let keys = |text: &str| Path::parse(text).map(|path| path.0);
        let owned = |keys: &[&str]| Ok(keys.iter().map(|key| (*key).to_owned()).collect());
        assert_eq!(keys("gravity.3"), owned(&["gravity", "3"]));
        assert_eq!(keys(" body.\"a.b\".mass "), owned(&["body", "a.b", "mass"]));
        for wrong in ["", ".", "a..b", "a.", "\"a", "\"a\"b"] {
            assert!(keys(wrong).is_err(), "{wrong}");
        }
    }
}
