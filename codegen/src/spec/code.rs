//! The stable codes of errors in a spec. A code keeps its meaning for ever; a new error takes a new number.
//!
//! Each code has a page `codes/E….md`: why that is an error, the smallest spec that has it, and one that has not.

macro_rules! codes {
    ($($name:ident $code:literal $meaning:literal)*) => {
        $(#[doc = $meaning] pub const $name: &str = $code;)*
        /// Every code with its meaning, ascending.
        pub const ALL: &[(&str, &str)] = &[$(($code, $meaning)),*];

        /// The pages of all codes, in the same order.
        const PAGES: &[&str] = &[$(include_str!(concat!("codes/", $code, ".md"))),*];
    };
}

codes! {
    SIZE "E0101" "The source is larger than 64 KiB."
    CHARACTER "E0102" "A character or token that the language does not have."
    BRACKETS "E0103" "A bracket without its partner, or brackets nested too deep."
    VERSION "E0104" "The version line is missing, or names a version that this generator does not know."
    EXPECTED "E0105" "Something else was expected here."
    STATEMENT "E0106" "No such statement."
    NUMBER "E0107" "A number in a form that is not exact or too long."
    POWER "E0108" "A power written as an operator."
    SURPLUS "E0109" "Text after the joint."

    UNDEFINED "E0201" "A name that is not defined here."
    MANIFOLD "E0202" "No such manifold."
    ALGEBRA "E0203" "No such Lie algebra, or no factor with it."
    FUNCTION "E0204" "No such function."
    UNIT "E0205" "No such unit."
    DUPLICATE_STATEMENT "E0206" "A statement that may stand once stands twice."
    DUPLICATE_NAME "E0207" "A name is defined twice, or is that of a stored scalar."
    RESERVED "E0208" "A name that belongs to the language or to Rust."
    FORM "E0209" "A name in the wrong case."
    SHAPES "E0210" "Operands whose shapes do not fit."
    ARGUMENTS "E0211" "Arguments that the function does not take."
    INDEX "E0212" "An index outside the matrix."
    FIELD "E0213" "No such part."
    DECLARED_SHAPE "E0214" "A declared matrix has the wrong shape."
    PHI "E0215" "A local coordinate outside Phi."

    MISSING "E0301" "A statement is missing."
    BASIS_MISSING "E0302" "A factor has no basis."
    VELOCITY_MISSING "E0303" "The frame of the velocity is not declared."
    VELOCITY_UNUSED "E0304" "A velocity frame where v is the rate of the coordinates."
    NOT_CLOSED "E0305" "A basis that does not close under the bracket."
    DEPENDENT "E0306" "A basis whose elements are dependent, or too many or too few."
    NOT_CONSTANT "E0307" "A basis element that is not constant."
    FREEDOMS "E0308" "Too many degrees of freedom, factors, stored scalars, bodies, ports or pins."
    UNUSED "E0309" "A parameter or a let that nothing uses."
    UNDEFINED_VALUE "E0310" "Division by zero, or a function outside its domain."
    TOO_LARGE "E0311" "A value that is too large to work with."
    CONSTRAINT "E0312" "A and S_bar that do not fit each other."
    SPEEDS "E0313" "Names of speeds that do not fit S_bar."
    POSE "E0314" "A 4×4 matrix that is no pose."
    RELATION "E0315" "A relation that is not a polynomial in the stored scalars of Q."
    RELATIONS "E0316" "Relations that contradict each other, say nothing, or have no normal form."
    HOME "E0317" "A home that is not constant or not on the manifold."
    LOCUS "E0318" "An exception that holds everywhere, nowhere or at home."
    RANGE "E0319" "A range without values, or whose ends are not numbers."
    REQUIREMENT "E0320" "A requirement that is not about parameters, or always or never true."
    FILE_NAME "E0321" "The file is not named after its joint."
    MAY_VANISH "E0322" "Division by a parameter that may be zero."
    UNPROVED "E0323" "An `unproved` of something that is no such claim, or that is proved."
    BODIES "E0324" "`H` beside `bodies`, or `H.name` without them."
    PORT "E0325" "A port that is no angle or length of Q, or that no velocity moves."
    CURVE "E0326" "Knots, ends or a continuation that make no curve."
    TABLE "E0327" "A file of knots that cannot be read."
    PIN "E0328" "A pin whose points are apart, or that holds other motions than it says."
    UNITS "E0329" "Quantities of different units that should be alike."

    DIMENSION "E0401" "The number of local coordinates is not the dimension of the manifold."
    PARENT_FRAME "E0402" "No constant directions to read in the parent frame."
    NO_CLOSED_FORM "E0403" "exp of the basis has no known closed form."
    NO_COMPLEMENT "E0405" "A or S_bar cannot be derived from the other by one formula."
    SINGULAR_VELOCITY_MAP "E0406" "S₀ is singular everywhere."
    DEPENDENT_TWISTS "E0407" "X has dependent columns everywhere."
    NOT_RIGID "E0408" "H is not a rigid motion."
    RETRACT_AT_ZERO "E0409" "Phi(Q, 0) is not Q."
    LEAVES_MANIFOLD "E0410" "Phi leaves the manifold."
    TWIST_MAP "E0411" "X does not span the velocities of H."
    TWIST_MAP_SLOPE "E0412" "X does not span the velocities of H near Q."
    VELOCITY_MAP_LOCUS "E0413" "S₀ is singular somewhere, or not shown to be regular everywhere."
    TWIST_MAP_LOCUS "E0414" "X loses rank somewhere, or is not shown to have full rank everywhere."
    FORBIDDEN_SPEEDS "E0415" "S_bar holds velocities that A forbids."
    SPEED_BASIS_LOCUS "E0416" "S_bar loses rank somewhere."
    CONSTRAINT_LOCUS "E0417" "A loses rank somewhere."
    WORK "E0418" "The derivation takes more work than the bound allows."
    TWIST_MAP_FRAME "E0419" "X is not the velocity in the declared frame."
    NOT_DEFINED "E0420" "A quotient, root, logarithm or angle that is not smooth everywhere."
    NOT_PROVED "E0421" "A claim that algebra does not decide: not proved, or undecided."
    ROUGH_CURVE "E0422" "A curve of which a derivative is needed that jumps."
}

/// What a code means: a title, why that is an error, a wrong and a right spec. `e305` and `305` are other spellings.
///
/// # Errors
/// A known code that differs from an unknown one in one digit, or by two that are exchanged; none where there is none.
pub fn explain(code: &str) -> Result<String, Option<&'static str>> {
    let digits = code.trim_start_matches(['E', 'e']);
    let padded = format!("E{digits:0>4}");
    let position = ALL.iter().position(|(known, _)| *known == padded);
    match position {
        Some(n) => Ok(format!("{}: {}\n\n{}", ALL[n].0, ALL[n].1, PAGES[n])),
        None => Err(nearest(&padded)),
    }
}

fn nearest(code: &str) -> Option<&'static str> {
    let mut codes = ALL.iter().map(|(known, _)| *known);
    codes.find(|known| strsim::damerau_levenshtein(known, code) == 1)
}
