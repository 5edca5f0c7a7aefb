//! Files of another kind than the one that is read: a scene in the place of a robot, the spec of a joint in the place of a scene.

use crate::diagnostics::Diagnostic;
use crate::source::Span;

/// What a text is, by its first line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// `hamel = 1`
    Scene,
    /// `hamel = 1;`
    Spec,
}

/// Why a text that is no XML is no robot.
pub(crate) fn no_robot(text: &str) -> Option<Diagnostic> {
    let (kind, span) = of(text)?;
    Some(match kind {
        Kind::Scene => Diagnostic::new(span, "this is a scene, not a robot in URDF, MJCF or SDF")
            .help("a scene is not imported: it is simulated as it is, from a file whose name ends in `.toml`"),
        Kind::Spec => Diagnostic::new(span, format!("{A_SPEC}, not a robot in URDF, MJCF or SDF"))
            .help(CHECK),
    })
}

/// Why a text is no scene.
pub(crate) fn no_scene(text: &str) -> Option<Diagnostic> {
    match of(text)? {
        (Kind::Spec, span) => {
            Some(Diagnostic::new(span, format!("{A_SPEC}, not a scene")).help(CHECK))
        }
        (Kind::Scene, _) => None,
    }
}

const A_SPEC: &str = "this is the spec of a joint";
const CHECK: &str =
    "`hamel joints check FILE` derives it; a scene names it, `joint = { type = \"…\" }`";

/// The kind, with the line that tells it: the first one that is no comment of either language.
fn of(text: &str) -> Option<(Kind, Span)> {
    let mut start = 0;
    let lines = text.split_inclusive('\n').map(|line| {
        let at = start;
        start += line.len();
        (at, line)
    });
    let is_comment =
        |line: &str| line.is_empty() || line.starts_with('#') || line.starts_with("//");
    let (at, line) = lines
        .map(|(at, line)| (at + line.len() - line.trim_start().len(), line.trim()))
        .find(|(_, line)| !is_comment(line))?;
    let version = line.strip_prefix("hamel")?.trim_start().strip_prefix('=')?;
    let number = version.trim_start();
    let rest = number.trim_start_matches(|c: char| c.is_ascii_digit());
    let kind = match rest.trim_start().chars().next() {
        _ if rest.len() == number.len() => return None,
        Some(';') => Kind::Spec,
        None | Some('#') => Kind::Scene,
        Some(_) => return None,
    };
    Some((kind, at..at + line.len()))
}

#[cfg(test)]
mod tests {
    use super::{Kind, of};

    #[test]
    fn the_version_line_tells_the_kind() {
        for (text, kind) in [
            ("# A top.\n\n  hamel = 1 # version\n", Some(Kind::Scene)),
            ("hamel=1", Some(Kind::Scene)),
            ("// A joint.\r\nhamel = 1;\r\njoint x {}", Some(Kind::Spec)),
            ("hamel = x", None),
            ("name = \"hamel = 1\"", None),
            ("<robot/>", None),
            ("", None),
        ] {
            assert_eq!(of(text).map(|(kind, _)| kind), kind, "{text:?}");
        }
        let (_, span) = of("#\n  hamel = 1;\n").expect("a spec");
        assert_eq!(span, 4..14);
    }
}
