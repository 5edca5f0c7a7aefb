//! Comments in bodies of emitted code, which tokens cannot hold: written as calls of a macro, turned into comments at last.

use proc_macro2::TokenStream;
use quote::quote;

/// The macro that stands for a comment until the tokens are text.
const MARK: &str = "hamel_comment!(";

/// A line of comment as a statement.
pub fn comment(text: &str) -> TokenStream {
    quote! { hamel_comment!(#text); }
}

/// The text with every such statement as a comment; a long one stands on three lines.
pub fn with_comments(text: &str) -> String {
    let mut lines = text.lines();
    let mut result = String::new();
    while let Some(line) = lines.next() {
        let bare = line.trim_start();
        let indent = &line[..line.len() - bare.len()];
        let argument = bare.strip_prefix(MARK).map(|rest| match rest {
            "" => {
                let argument = lines.next().unwrap_or_default();
                lines.next();
                argument.trim_start()
            }
            _ => rest.trim_end_matches(");"),
        });
        match argument {
            Some(text) => result += &format!("{indent}// {}\n", text.trim_matches('"')),
            None => result += &format!("{line}\n"),
        }
    }
    result
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
