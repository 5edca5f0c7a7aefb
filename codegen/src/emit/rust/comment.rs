//! Comments in bodies of emitted code, which tokens cannot hold: written as calls of a macro, turned into comments at last.

use proc_macro2::TokenStream;
use quote::quote;

/// The macro that stands for a comment until the tokens are text.
const MARK: &str = "hamel_comment!(";

/// A line of comment as a statement.
pub fn comment(text: &str) -> TokenStream {
    quote! { hamel_comment!(#text); }
}

/// The text with every such statement as a comment. The printer breaks a long one into three lines.
pub fn with_comments(text: &str) -> String {
    let mut written = String::with_capacity(text.len());
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let bare = line.trim_start();
        let indent = &line[..line.len() - bare.len()];
        let quoted = match bare.strip_prefix(MARK) {
            Some("") => {
                let quoted = lines.next().map(str::trim);
                lines.next();
                quoted
            }
            rest => rest.and_then(|rest| rest.strip_suffix(");")),
        };
        written += &match quoted {
            Some(quoted) => format!("{indent}// {}\n", quoted.trim_matches('"')),
            None => format!("{line}\n"),
        };
    }
    written
}

#[cfg(test)]
mod tests {
    use super::{comment, with_comments};
    use quote::quote;

    #[test]
    fn comments_survive_printing() {
        let names = ["cos_q"; 20].join(", ");
        for text in ["line 3 `H`: sin_q, cos_q", &format!("line 4 `X`: {names}")] {
            let comment = comment(text);
            let file = syn::parse2(quote! { fn f() { #comment let a = 1; } }).expect("is Rust");
            assert_eq!(
                with_comments(&prettyplease::unparse(&file)),
                format!("fn f() {{\n    // {text}\n    let a = 1;\n}}\n")
            );
        }
    }
}
