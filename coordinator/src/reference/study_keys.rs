//! Keys of `study.toml` besides those that it shares with `model.toml`: its own, and the numerical settings.

use super::key::Absent::{Nothing, Required, Value, Words};
use super::key::Kind::{Either, List as List_, Number, Pattern, Table, Text, Truth, Whole, Word};
use super::key::{Key, Kind, List, Range};
use solver::settings::{NumberList, SearchSettings};

/// Largest number of forcing amplitudes of a study.
pub const MAX_LEVELS: usize = 100_000;

const LEVEL: Kind = Number(Range::POSITIVE);
const COUNT: Kind = Whole(Range::from(1.0));
const POSITIVE: Kind = Number(Range::POSITIVE);
/// A number of rad/s, or a text with its unit.
const FREQUENCY: Kind = Either(&[
    POSITIVE,
    Pattern(r"^\s*(?=[^eE]*[1-9])([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*(Hz|hz|rad/s)\s*$"),
]);

/// A length, a frequency or both.
const UNITS: &str = r"^\s*((m|mm|um|µm)\s*(,\s*(rad/s|Hz)\s*)?|(rad/s|Hz)\s*(,\s*(m|mm|um|µm)\s*)?)$";

/// Keys of the study itself.
pub(super) const OWN: &[Key] = &[
    Key {
        path: "name",
        kind: Pattern(r"\S"),
        default: Words("that of the model"),
        unit: "",
        meaning: "Shown to people; the folder of a run is named after it.",
        example: "\"without friction\"",
    },
    Key {
        path: "model",
        kind: Text,
        default: Value("\".\""),
        unit: "",
        meaning: "Folder of the model, relative to that of the study.",
        example: "\".\"",
    },
    Key {
        path: "units",
        kind: Pattern(UNITS),
        default: Value("\"m,rad/s\""),
        unit: "",
        meaning: "Units of the tables and figures of the run, and of what isola check says: a length (m, mm or um), a frequency (rad/s or Hz), or both. What models and studies give stays in SI units. Also --units.",
        example: "\"mm,Hz\"",
    },
    Key {
        path: "amplitudes",
        kind: Either(&[
            LEVEL,
            Text,
            List_(&List { fewest: 1, most: Some(MAX_LEVELS), ..List::of(Either(&[LEVEL, Text])) }),
        ]),
        default: Required,
        unit: "A",
        meaning: "Forcing amplitudes A: a list, or a text with numbers and ranges \"start:stop:step\" that include both ends. May be left out where they are typed after --amplitudes.",
        example: "\"20:140:20\"",
    },
];

const fn section(path: &'static str, meaning: &'static str) -> Key {
    Key { path, kind: Table, default: Nothing, unit: "", meaning, example: "" }
}

/// Numerical settings: [`solver::settings::Settings`].
pub(super) const NUMERICS: &[Key] = &[
    section("harmonics", "Truncation of the Fourier series."),
    Key {
        path: "harmonics.count",
        kind: Whole(Range::within(1.0, 400.0)),
        default: Value("10"),
        unit: "",
        meaning: "Number of harmonics H, at least that of the forcing. What a run lacks for want of harmonics its closing message says.",
        example: "20",
    },
    Key {
        path: "harmonics.samples",
        kind: Whole(Range::within(4.0, 1_048_576.0)),
        default: Value("512"),
        unit: "",
        meaning: "Instants a period at which laws that do not switch are evaluated, at least 4 H; polynomials, which need fewer, at fewer.",
        example: "1024",
    },
    Key {
        path: "harmonics.quadrature",
        kind: Word(&[
            (
                "arcs",
                "from one switch to the next (the exact arcs of contact, of sticking and of sliding): smooth, independent of the number of samples",
            ),
            (
                "samples",
                "by the samples, as the paper does; where the friction of a contact nearly stops or reverses its sliding, this is right",
            ),
        ]),
        default: Value("\"arcs\""),
        unit: "",
        meaning: "How laws that switch, stops and dry friction, are integrated over a period.",
        example: "\"samples\"",
    },
    section(
        "frequency",
        "Frequencies of the response between which responses are wanted. Numbers are in rad/s; a text has its unit with it, as in \"150 Hz\". Main branches are followed beyond them until the response is the ordinary one there; other branches end at bounds that are given.",
    ),
    Key {
        path: "frequency.min",
        kind: FREQUENCY,
        default: Words("10 % below the lowest resonance: of the backbones, of the force with their modes"),
        unit: "rad/s",
        meaning: "Lower bound.",
        example: "\"14.5 Hz\"",
    },
    Key {
        path: "frequency.max",
        kind: FREQUENCY,
        default: Words("10 % above the highest resonance: of the backbones, of the force with their modes"),
        unit: "rad/s",
        meaning: "Upper bound, above frequency.min.",
        example: "9.5",
    },
    section("continuation", "How curves are followed. Steps are scaled arc lengths."),
    Key {
        path: "continuation.initial_step",
        kind: POSITIVE,
        default: Value("0.02"),
        unit: "",
        meaning: "First step, above min_step.",
        example: "0.01",
    },
    Key {
        path: "continuation.min_step",
        kind: POSITIVE,
        default: Value("1e-7"),
        unit: "",
        meaning: "Smallest step: a branch that needs a smaller one has stalled.",
        example: "1e-8",
    },
    Key {
        path: "continuation.max_step",
        kind: POSITIVE,
        default: Value("0.1"),
        unit: "",
        meaning: "Largest step, above min_step; where frequency or motion are more than five times their references, longer in proportion.",
        example: "0.05",
    },
    Key {
        path: "continuation.target_factorisations",
        kind: COUNT,
        default: Value("2"),
        unit: "",
        meaning: "Factorisations a point that leave the step as it is; with fewer it grows, with more it shrinks.",
        example: "3",
    },
    Key {
        path: "continuation.min_cosine",
        kind: Number(Range::SHARE),
        default: Value("0.9"),
        unit: "",
        meaning: "Smallest cosine between a step and the tangent that it started with.",
        example: "0.95",
    },
    Key {
        path: "continuation.predictor",
        kind: Word(&[
            ("tangent", "along the tangent, from the Jacobian that is factorised already"),
            ("secant", "through the last two points"),
        ]),
        default: Value("\"tangent\""),
        unit: "",
        meaning: "Direction in which the next point is predicted.",
        example: "\"secant\"",
    },
    Key {
        path: "continuation.corrector",
        kind: Word(&[("hyperplane", "Keller's, normal to the predictor"), ("sphere", "round the last point")]),
        default: Value("\"hyperplane\""),
        unit: "",
        meaning: "Scalar equation of the corrector.",
        example: "\"sphere\"",
    },
    section("continuation.newton", "Newton's method."),
    Key {
        path: "continuation.newton.tolerance",
        kind: POSITIVE,
        default: Value("1e-12"),
        unit: "",
        meaning: "Largest scaled residual of a converged point. Where rounding alone leaves more, what cannot be improved any more is converged.",
        example: "1e-10",
    },
    Key {
        path: "continuation.newton.max_iterations",
        kind: COUNT,
        default: Value("10"),
        unit: "",
        meaning: "Iterations before giving up.",
        example: "15",
    },
    Key {
        path: "continuation.newton.damped",
        kind: Truth,
        default: Value("false"),
        unit: "",
        meaning: "Whether a step that does not reduce the residual is shortened.",
        example: "true",
    },
    section("backbone", "Backbones: damped nonlinear normal modes, from which windows of isolas follow."),
    Key {
        path: "backbone.modes",
        kind: Either(&[
            Pattern(r"^(auto|\s*[0-9]+\s*(,\s*[0-9]+\s*)*)$"),
            COUNT,
            List_(&List { of: COUNT, fewest: 1, most: Some(NumberList::MOST), distinct: true }),
        ]),
        default: Value("\"auto\""),
        unit: "",
        meaning: "Modes followed, from 1, the primary one first; or \"auto\": the lowest that the force drives, and every other one that frequency range and forcing can reach.",
        example: "[1, 2]",
    },
    Key {
        path: "backbone.mode",
        kind: COUNT,
        default: Nothing,
        unit: "",
        meaning: "Another way to give backbone.modes: one mode alone.",
        example: "1",
    },
    Key {
        path: "backbone.max_amplitude",
        kind: POSITIVE,
        default: Words(
            "8 reference lengths (gaps), and farther where the threshold A* is below twice the largest forcing",
        ),
        unit: "m",
        meaning: "Largest amplitude of the first monitored dof: how far free motion is followed.",
        example: "2.5",
    },
    Key {
        path: "backbone.min_frequency",
        kind: FREQUENCY,
        default: Words("a quarter of the eigenfrequency of the mode"),
        unit: "rad/s",
        meaning: "Lowest frequency.",
        example: "0.1",
    },
    Key {
        path: "backbone.max_frequency",
        kind: FREQUENCY,
        default: Words(
            "four times the eigenfrequency of the mode, and more where the threshold A* is below twice the largest forcing there",
        ),
        unit: "rad/s",
        meaning: "Highest frequency, above min_frequency.",
        example: "9.5",
    },
    Key {
        path: "backbone.max_points",
        kind: COUNT,
        default: Value("6000"),
        unit: "",
        meaning: "Largest number of points.",
        example: "10000",
    },
    Key {
        path: "backbone.criterion",
        kind: Word(&[
            (
                "balance",
                "W > |R_lin + R_nl|, the balance itself: where nonlinear forces feed energy in, only this one finds all",
            ),
            ("sufficient", "W > |R_lin| + |R_nl|, the paper's"),
        ]),
        default: Value("\"balance\""),
        unit: "",
        meaning: "Which energies the work W of the forcing has to exceed for an isola to be predicted.",
        example: "\"sufficient\"",
    },
    Key {
        path: "backbone.equation",
        kind: Word(&[
            ("damped_mode", "the damped nonlinear normal mode, the paper's"),
            (
                "conservative_mode",
                "the same without linear damping; the energy balance still counts what the damping dissipates",
            ),
            (
                "phase_resonance",
                "forced responses in quadrature with the forcing: the one for strongly damped structures",
            ),
        ]),
        default: Value("\"damped_mode\""),
        unit: "",
        meaning: "What the backbone is.",
        example: "\"phase_resonance\"",
    },
    section("branch", "Branches of forced responses."),
    Key {
        path: "branch.max_points",
        kind: COUNT,
        default: Value("6000"),
        unit: "",
        meaning: "Largest number of points in each direction.",
        example: "10000",
    },
    Key {
        path: "branch.closure",
        kind: POSITIVE,
        default: Value("0.01"),
        unit: "",
        meaning: "Accepted, and without effect: a branch has closed when it converges onto its first point.",
        example: "0.01",
    },
    Key {
        path: "branch.max_amplitude",
        kind: POSITIVE,
        default: Nothing,
        unit: "m",
        meaning: "Largest amplitude of the first monitored dof.",
        example: "3",
    },
    section("search", "The search for isolas that no window of the energy balance leads to."),
    Key {
        path: "search.effort",
        kind: Word(&[
            ("none", "in the windows only"),
            (
                "standard",
                "up to 200 folds of the branches found are followed over the forcing, and random starts are tried, 16384 with a small model and fewer with larger ones, shared among the levels (those that isola extend adds have their own), beside a quarter as many at up to twice the largest forcing, for folds that lead back; where nothing leads to motions of several periods of the force, homotopies as well, a thirty-second as many",
            ),
            ("thorough", "up to 5000 folds, and 16 times as many starts"),
        ]),
        default: Value("\"standard\""),
        unit: "",
        meaning: "How hard is looked, for every order of search.harmonics so much; also --search.",
        example: "\"thorough\"",
    },
    Key {
        path: "search.starts",
        kind: Whole(Range::within(0.0, SearchSettings::MOST_STARTS as f64)),
        default: Words("as search.effort says"),
        unit: "",
        meaning: "Random starts for every order, shared among the levels, in batches of 16: most of what a search of a small model takes its time for, and what alone finds isolas that neither windows nor folds lead to. With search.effort = \"none\" there are none.",
        example: "2048",
    },
    Key {
        path: "search.harmonics",
        kind: Either(&[
            Pattern(r"^\s*[0-9]+\s*(,\s*[0-9]+\s*)*$"),
            COUNT,
            List_(&List { of: COUNT, fewest: 1, most: Some(NumberList::MOST), distinct: true }),
        ]),
        default: Words("the model's forcing.harmonic alone"),
        unit: "",
        meaning: "Orders m of the motions that are looked for, ascending: those of order m last m periods of the force, which acts on their harmonic m whatever forcing.harmonic says. Main branches are followed of the first; of others only what earlier ones do not have. Bounds of the frequency are those of the first order's motions, and the force has the same ones in all orders; where none is given each order's own backbones say how far its motions are followed. harmonics.count holds for all: a period of order 3 needs three times as many for the same resolution. Also --orders.",
        example: "[1, 2, 3]",
    },
    section("verify", "Verification of what was found by time marching, with its stability."),
    Key {
        path: "verify.effort",
        kind: Word(&[
            ("none", "nothing"),
            ("standard", "every branch that is not a main one, and what is around the peaks of main branches"),
            ("all", "every branch, and what unstable motions turn into where it loses its stability or never has it"),
        ]),
        default: Value("\"standard\""),
        unit: "",
        meaning: "How much is verified; also --verify, and afterwards isola verify.",
        example: "\"all\"",
    },
];
