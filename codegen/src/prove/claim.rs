//! Something that is true of a joint, and how that is known.

/// How a claim was proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proof {
    /// The difference of both sides has normal form 0.
    NormalForm,
    /// A certificate: a minor or determinant whose normal form is a constant other than 0, or a polynomial inverse.
    Certificate,
    /// None: evaluated at points, where it holds, and accepted because the spec says `unproved`.
    Checked,
}

impl Proof {
    /// Name in machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Self::NormalForm => "normal_form",
            Self::Certificate => "certificate",
            Self::Checked => "checked",
        }
    }
}

/// Something that was proved of a joint, or checked where the spec says so.
#[derive(Clone, Debug)]
pub struct Claim {
    /// Stable name, `pose_in_se3` and the like.
    pub name: &'static str,
    /// The claim in the notation of the paper.
    pub statement: String,
    /// How it was proved.
    pub proof: Proof,
    /// The certificate, where there is one; the author's reason for a claim that is not proved.
    pub detail: String,
    /// Points at which a claim that is not proved was evaluated: 0 for proofs.
    pub points: usize,
}
