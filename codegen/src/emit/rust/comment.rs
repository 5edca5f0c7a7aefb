//! Comments in bodies of emitted code, which tokens cannot hold: written as calls of a macro, turned into comments at last.

use proc_macro2::TokenStream;
use quote::quote;

/// The macro that stands for a comment until the tokens are text.
const MARK: &str = "hamel_comment!(\"";

/// A line of comment as a statement.
pub fn comment(text: &str) -> TokenStream {
    quote! { hamel_comment!(#text); }
}

/// The text with every such statement as a comment.
pub fn with_comments(text: &str) -> String {
    let line = |line: &str| {
        let bare = line.trim_start();
        let indent = &line[..line.len() - bare.len()];
        let comment = bare
            .strip_prefix(MARK)
            .and_then(|rest| rest.strip_suffix("\");"));
        match comment {
            Some(comment) => format!("{indent}// {comment}\n"),
            None => format!("{line}\n"),
        }
    };
    text.lines().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::{comment, with_comments};
    use quote::quote;

    #[test]
    fn comments_survive_printing() {
        let comment = comment("line 3 `H`: sin_q, cos_q");
        let file = syn::parse2(quote! { fn f() { #comment let a = 1; } }).expect("is Rust");
        let text = with_comments(&prettyplease::unparse(&file));
        assert_eq!(
            text,
            "fn f() {\n    // line 3 `H`: sin_q, cos_q\n    let a = 1;\n}\n"
        );
    }
}
