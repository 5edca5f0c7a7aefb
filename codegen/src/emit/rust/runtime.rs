//! Where emitted code finds the runtime. Tokens are written with `::hamel::…`; a crate that has the runtime under another path says so.

use super::tokens::ident;
use proc_macro2::{Group, TokenStream, TokenTree};
use quote::{ToTokens, quote};
use std::fmt::{Display, Formatter};
use std::str::FromStr;

/// The name in the tokens that this crate writes.
const WRITTEN: &str = "hamel";

/// The path of the runtime in emitted code; `::hamel`, the crate that users depend on, unless a build says otherwise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Runtime {
    /// `crate` or the name of a crate, and modules.
    parts: Vec<String>,
}

/// A text that is no path of a module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RuntimeError {
    text: String,
}

impl Default for Runtime {
    fn default() -> Self {
        Self {
            parts: vec![WRITTEN.to_owned()],
        }
    }
}

impl FromStr for Runtime {
    type Err = RuntimeError;

    /// `::name`, `name::module`, `crate::module`. A name without `crate` before it is that of a crate.
    fn from_str(text: &str) -> Result<Self, RuntimeError> {
        let error = || RuntimeError {
            text: text.to_owned(),
        };
        let path = syn::parse_str::<syn::Path>(text).map_err(|_| error())?;
        let is_plain = path.segments.iter().all(|part| part.arguments.is_none());
        let parts: Vec<String> = path
            .segments
            .iter()
            .map(|part| part.ident.to_string())
            .collect();
        let is_relative = parts.iter().any(|part| part == "self" || part == "super");
        match is_plain && !is_relative {
            true => Ok(Self { parts }),
            false => Err(error()),
        }
    }
}

impl Display for RuntimeError {
    fn fmt(&self, out: &mut Formatter<'_>) -> std::fmt::Result {
        write!(
            out,
            "the runtime's path `{}` is no path of a module; write `::hamel`, `mechanics::hamel`, or one that begins with `crate`",
            self.text
        )
    }
}

impl std::error::Error for RuntimeError {}

impl Runtime {
    /// The tokens with this path in place of each `::hamel` that begins a path.
    pub(super) fn placed(&self, tokens: TokenStream) -> TokenStream {
        if *self == Self::default() {
            return tokens;
        }
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut placed = TokenStream::new();
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            if is_runtime(&tokens, at) {
                placed.extend(self.path());
                at += 3;
                continue;
            }
            match token {
                TokenTree::Group(group) => self.group(group).to_tokens(&mut placed),
                token => token.to_tokens(&mut placed),
            }
            at += 1;
        }
        placed
    }

    fn path(&self) -> TokenStream {
        let parts = self.parts.iter().map(|part| ident(part));
        match self.parts.first().is_some_and(|part| part == "crate") {
            true => quote! { #(#parts)::* },
            false => quote! { ::#(#parts)::* },
        }
    }

    fn group(&self, group: &Group) -> Group {
        let mut placed = Group::new(group.delimiter(), self.placed(group.stream()));
        placed.set_span(group.span());
        placed
    }
}

/// Whether `::hamel::` begins here, not as the continuation of a path.
fn is_runtime(tokens: &[TokenTree], at: usize) -> bool {
    let is_colon = |index: usize| matches!(tokens.get(index), Some(TokenTree::Punct(punct)) if punct.as_char() == ':');
    let is_named = matches!(tokens.get(at + 2), Some(TokenTree::Ident(ident)) if ident == WRITTEN);
    let continues = at.checked_sub(1).is_some_and(
        |before| matches!(tokens[before], TokenTree::Ident(ref word) if word != "use" && word != "impl"),
    );
    is_colon(at) && is_colon(at + 1) && is_named && is_colon(at + 3) && !continues
}
