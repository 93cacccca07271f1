//! What `isola check` says of laws, and of structures that are not held.

use crate::check::{MODEL, checked};

/// The mass with a law of its own instead of the stop.
fn with_law(law: &str) -> String {
    let linear = MODEL.split("[contact]").next().unwrap();
    format!("{linear}[[laws]]\nname = \"spring\"\ndof = \"x\"\nlaw = {law}\n")
}

/// A joint that sticks shifts the resonance at 100 rad/s.
#[test]
fn bounds_on_the_flank_of_what_is_no_resonance_of_small_motions() {
    let bounds = [("frequency.min", "90"), ("frequency.max", "100.5")];
    let cuts = |law: &str| checked(&with_law(law), "0.3", &bounds).0.into_iter().find(|told| told.contains("cuts"));
    let sticking = cuts("{ jenkins = { stiffness = 1e3, limit = 0.5 } }").unwrap();
    assert!(
        sticking.contains("cuts through the resonance of mode 1 (of the matrices alone) at 100 rad/s"),
        "{sticking}"
    );
    let cubic = cuts("{ polynomial_spring = { terms = [{ power = 3, coefficient = 2e8 }] } }").unwrap();
    assert!(cubic.contains("cuts through the resonance of mode 1 at 100 rad/s"), "{cubic}");
}

/// A force of amplitude A brings π A x a period at resonance, friction takes 4 F x: from A = 4 F/π on the motion grows for ever.
#[test]
fn dry_friction_alone_does_not_bound_a_resonance() {
    let undamped = |law: &str| with_law(law).replace("1e-2 }]", "0 }]");
    for law in ["{ jenkins = { stiffness = 50, limit = 0.5 } }", "{ tanh_friction = { limit = 0.5, velocity = 0.01 } }"]
    {
        let (warnings, text) = checked(&undamped(law), "0.3", &[]);
        let told = "mode 1 has no damping, and dry friction takes no more than its limit lets it: from some forcing on the response at its \
                    resonance may have no bound";
        assert!(warnings.iter().any(|warning| warning.starts_with(told)), "{text}");
        let (warnings, text) = checked(&with_law(law), "0.3", &[]);
        assert!(!warnings.iter().any(|warning| warning.contains("no damping")), "{text}");
    }
    let (warnings, text) =
        checked(&undamped("{ polynomial_damper = { terms = [{ power = 3, coefficient = 1 }] } }"), "0.3", &[]);
    assert!(!warnings.iter().any(|warning| warning.contains("no damping")), "{text}");
}

/// ω = 100 rad/s and ζ = 1e-2: A = 0.2 makes 1 mm, and the damping takes 0.2 N; a cubic spring of 2e8 N/m³ takes as much there.
#[test]
fn laws_that_hardly_do_anything() {
    let cubic = |coefficient: &str| {
        with_law(&format!("{{ polynomial_spring = {{ terms = [{{ power = 3, coefficient = {coefficient} }}] }} }}"))
    };
    for coefficient in ["2e8", "4e5", "2e4"] {
        let (warnings, text) = checked(&cubic(coefficient), "0.1,0.2", &[]);
        // It takes as much as the damping where the response is √(2e8/c) times as large: up to a hundred times.
        assert_eq!(warnings, [] as [&str; 0], "{text}");
    }
    let (warnings, text) = checked(&cubic("2e2"), "0.1,0.2", &[]);
    let [warning] = &warnings[..] else { panic!("{text}") };
    assert!(
        warning.starts_with("practically linear: at A = 0.2 the laws would matter only where the response is "),
        "{warning}"
    );
    assert!(warning.ends_with(" times the linear one or more; check units of `spring`"), "{warning}");
    // From which forcing on it does is said where nothing has a gap that tells it: here from √(2e8/c) times 0.2 on.
    for (coefficient, forcing) in [("2e8", "0.2"), ("2e10", "0.02"), ("2e6", "2")] {
        let (_, text) = checked(&cubic(coefficient), "0.1,0.2", &[]);
        let told = format!(
            "laws        their forces are as large as that of the damping from about A = {forcing} on, at the resonance of mode 1, "
        );
        assert!(text.contains(&told), "{text}");
    }
    // What is linear altogether is no less told than what is so for all that can be seen.
    let linear = with_law("{ polynomial_spring = { terms = [{ power = 1, coefficient = 5 }] } }");
    let (warnings, text) = checked(&linear, "0.2", &[]);
    let [warning] = &warnings[..] else { panic!("{text}") };
    assert!(
        warning.starts_with("practically linear: at the resonances followed no term") && !text.contains("laws    "),
        "{text}"
    );
    // Ten times the force is enough of a law ten times as hard.
    assert!(checked(&cubic("2e2"), "20", &[]).0.is_empty());
    // Nor is it said where nothing damps the resonance, at which the linear response has no size.
    let undamped = cubic("2e8").replace("1e-2 }]", "0 }]");
    let (warnings, text) = checked(&undamped, "0.2", &[]);
    assert!(!warnings.is_empty() && !text.contains("practically linear"), "{text}");
    // A law that is no polynomial may matter at any amplitude.
    let friction = with_law("{ jenkins = { stiffness = 1, limit = 1e-9 } }");
    let (warnings, text) = checked(&friction, "0.2", &[]);
    assert!(warnings.is_empty() && !text.contains("laws    "), "{text}");
}

/// The structure holds 1e4 N/m: a stop given in kN/m is a thousand times too soft, and one of a hundredth of it may well matter.
#[test]
fn stops_and_joints_that_are_too_soft() {
    let stop = |stiffness: &str| with_law(&format!("{{ penalty_spring = {{ stiffness = {stiffness}, gap = 1e-3 }} }}"));
    let (warnings, text) = checked(&stop("0.06"), "0.3", &[]);
    let told = "`spring`: its stiffness, 0.06 N/m, is 6e-6 of that of the structure there, 10000 N/m, and changes next to nothing: are the units \
                N/m?";
    assert_eq!(warnings, [told], "{text}");
    let joint = with_law("{ jenkins = { stiffness = 0.06, limit = 1 } }");
    assert_eq!(checked(&joint, "0.3", &[]).0, [told]);
    for stiffness in ["6", "100", "1e4", "1e9"] {
        assert_eq!(checked(&stop(stiffness), "0.3", &[]).0, [] as [&str; 0], "{stiffness}");
    }
    // Where next to nothing damps a resonance it moves by more than its width.
    let undamped = stop("0.06").replace("ratio = 1e-2", "ratio = 1e-6");
    assert_ne!(undamped, stop("0.06"));
    assert!(!checked(&undamped, "3e-5", &[]).0.iter().any(|warning| warning.contains("next to nothing")));
}

/// A joint of 3e4 N/m beside a spring of 1e4 N/m doubles the frequency as long as it sticks.
#[test]
fn modes_of_small_motions() {
    let (_, text) = checked(&with_law("{ jenkins = { stiffness = 3e4, limit = 1 } }"), "0.2", &[]);
    let told =
        "            of small motions, with `spring` (30000 N/m): 200 rad/s; those above are of the matrices alone\n";
    assert!(text.contains(told), "{text}");
    let linear = with_law(
        "{ polynomial_spring = { terms = [{ power = 3, coefficient = 2e8 }, { power = 1, coefficient = 2.1e3 }] } }",
    );
    assert!(checked(&linear, "0.2", &[]).1.contains("`spring` (2100 N/m): 110 rad/s"));
    assert!(!checked(MODEL, "0.2", &[]).1.contains("small motions"));
}

/// A joint of 3e4 N/m beside 1e4 N/m that sticks: 200 rad/s, and a damping of 2 N s/m is one of ζ = 5e-3 there. It slips at 1 N, beyond
/// 1/3e4 m: from A = 2 ζ √(1 − ζ²) 4e4 N/m × 1/3e4 m on, at 200 √(1 − 2 ζ²) rad/s.
#[test]
fn where_a_joint_slips_first() {
    let joint = with_law("{ jenkins = { stiffness = 3e4, limit = 1 } }");
    let slips = |model: &str, set: &[(&str, &str)]| {
        let (_, text) = checked(model, "0.2", set);
        text.lines().find_map(|line| line.strip_prefix("slips       ")).map(String::from)
    };
    let told = slips(&joint, &[]).unwrap();
    let expected = "from A = 0.0133332 on, spring slips first, at 199.995 rad/s, near the resonance of mode 1 as long as all sticks, in the linear \
                    response (looked for at bounds and at resonances up to those of modes that are followed; isolas may be there much earlier)";
    assert_eq!(told, expected);
    // Beyond the resonance it resists with about 400² − 4e4 N/m: at 400 rad/s A = 12e4/3e4.
    let bounds = [("frequency.min", "400"), ("frequency.max", "500")];
    let told = slips(&joint, &bounds).unwrap();
    assert!(told.starts_with("from A = 4.00") && told.contains(" at the bound 400 rad/s, in the linear"), "{told}");
    // The force has twice the frequency of the response.
    let twice = joint.replace("[forcing]", "[forcing]\nharmonic = 2");
    let told = slips(&twice, &[]).unwrap();
    assert!(told.starts_with("from A = 0.0133332 on, spring slips first, at 99.9975 rad/s, "), "{told}");
    // A velocity of v0 at resonance, where friction takes F/v0 beside 2 N s/m: A = (2 + F/v0) v0, wherever the structure would be locked.
    let friction = with_law("{ tanh_friction = { limit = 0.1, velocity = 0.01 } }");
    let told = slips(&friction, &[]).unwrap();
    assert!(
        told.starts_with(
            "from A = 0.12 on, spring slides (its velocity reaches that of its regularisation) first, at 100 "
        ),
        "{told}"
    );
    // What has a gap may touch before.
    let both = format!(
        "{MODEL}\n[[laws]]\nname = \"strip\"\ndof = \"x\"\nlaw = {{ jenkins = {{ stiffness = 3e4, limit = 1 }} }}\n"
    );
    let told = slips(&both, &[]).unwrap();
    assert!(
        told.contains(", strip slips first, ") && told.contains("in the linear response with nothing that touches"),
        "{told}"
    );
    assert_eq!(slips(MODEL, &[]), None);
}

/// Two masses of which a joint ties one to the ground: against the response of the structure with a spring in its place.
#[test]
fn where_one_of_two_joints_slips_first() {
    let model = |stiffness: [f64; 2], laws: &str| {
        let [a, b] = stiffness;
        format!(
            "name = \"pair\"\ndofs = [\"p\", \"q\"]\nmonitors = [\"q\"]\n[matrices]\nmass = [[1, 0], [0, 1]]\n\
             stiffness = [[{a}, -1e4], [-1e4, {b}]]\ndamping = [[4, -2], [-2, 4]]\n[forcing]\nshape = {{ dofs = {{ p = 1 }} }}\n{laws}"
        )
    };
    let law =
        |name: &str, dof: &str, law: &str| format!("[[laws]]\nname = \"{name}\"\ndof = \"{dof}\"\nlaw = {{ {law} }}\n");
    let joints = law("first", "p", "jenkins = { stiffness = 1e4, limit = 5 }")
        + &law("second", "q", "jenkins = { stiffness = 2e4, limit = 2 }");
    // Stops at 5/1e4 m and 2/2e4 m touch where such joints slip.
    let stops = law("first", "p", "penalty_spring = { stiffness = 1e4, gap = 5e-4 }")
        + &law("second", "q", "penalty_spring = { stiffness = 2e4, gap = 1e-4 }");
    let said = |model: &str, what: &str| {
        let (_, text) = checked(model, "1", &[("backbone.modes", "[1, 2]")]);
        let line = text.lines().find(|line| line.starts_with(what)).unwrap_or_else(|| panic!("{text}")).to_string();
        let numbers = line.split([' ', ',']).filter_map(|word| word.parse::<f64>().ok()).collect::<Vec<_>>();
        (line, numbers)
    };
    let (slips, found) = said(&model([2e4, 2e4], &joints), "slips ");
    let (touches, expected) = said(&model([3e4, 4e4], &stops), "touches ");
    assert!(slips.contains(", second slips first, ") && touches.contains(", second first, "), "{slips}\n{touches}");
    assert!(
        (found[0] / expected[0] - 1.0).abs() < 1e-5 && (found[1] / expected[1] - 1.0).abs() < 1e-5,
        "{slips}\n{touches}"
    );
}

/// What holds a joint changes what touches: nothing is said of levels by a response without it.
#[test]
fn what_touches_first_without_what_acts_at_rest() {
    let joint = "\n[[laws]]\nname = \"strip\"\ndof = \"x\"\nlaw = { jenkins = { stiffness = 3e4, limit = 1 } }\n";
    let (warnings, text) = checked(&format!("{MODEL}{joint}"), "0.1", &[]);
    let told = "at the resonance of mode 1, in the response of the matrices alone; with `strip` it may be much earlier or later; isolas may be there, and touch, from far lower forcing on, or be born at several times it, or at tens of times: levels from a third of it to five times it are a start, and, where these show none, larger ones\n";
    assert!(text.contains(told) && warnings.is_empty(), "{warnings:?}\n{text}");
}

/// The structure holds 1e4 N/m: a spring of −1e8 N/m³ takes that away at 10 mm, to which a force of 100 N bends it.
#[test]
fn a_spring_that_pushes_away() {
    let spring = |terms: &str| with_law(&format!("{{ polynomial_spring = {{ terms = [{terms}] }} }}"));
    let softening = spring("{ power = 3, coefficient = -1e8 }");
    assert_eq!(checked(&softening, "50,90", &[]).0, [] as [&str; 0]);
    let (warnings, text) = checked(&softening, "50,1e6", &[]);
    let told = "`spring` pushes away beyond 0.01 m, with more than the structure holds, and the static response to A = 1e6 alone would be \
                100 m: check units and signs";
    assert_eq!(warnings, [told], "{text}");
    // A buckled beam is held farther out, and so is what lets go in between only.
    let buckled = spring("{ power = 1, coefficient = -1.5e4 }, { power = 3, coefficient = 1e8 }");
    let snapping = spring("{ power = 3, coefficient = -1e8 }, { power = 5, coefficient = 2e11 }");
    for model in [&buckled, &snapping] {
        let warnings = checked(model, "1e6", &[]).0;
        assert!(!warnings.iter().any(|warning| warning.contains("pushes away")), "{warnings:?}");
    }
    // One way is enough; what grows again holds.
    assert_eq!(checked(&spring("{ power = 2, coefficient = 1e6 }"), "200", &[]).0.len(), 1);
    let held = spring("{ power = 3, coefficient = -1e8 }, { power = 5, coefficient = 1e12 }");
    assert_eq!(checked(&held, "1e6", &[]).0, [] as [&str; 0]);
}

#[test]
fn a_damper_that_feeds_energy_in() {
    let term = |power: usize, coefficient: f64| format!("{{ power = {power}, coefficient = {coefficient} }}");
    let damper = |terms: &str| with_law(&format!("{{ polynomial_damper = {{ terms = [{terms}] }} }}"));
    let (warnings, _) = checked(&damper(&term(2, 50.0)), "0.2", &[]);
    let even = "`spring`: a polynomial_damper of the even power 2 feeds energy in during half of each period";
    assert_eq!(warnings, [even]);
    assert!(checked(&damper(&term(3, 50.0)), "0.2", &[]).0.is_empty());
    // One percent of the critical damping, 2 ω m, is 2 N s/m.
    let pump = |linear: f64| checked(&damper(&format!("{}, {}", term(1, linear), term(3, 50.0))), "0.2", &[]).0;
    assert!(pump(-1.9).is_empty());
    let feeds = "mode 1: linear terms of polynomial_damper laws feed in more than the damping takes; the structure can vibrate by itself from \
                 rest";
    assert_eq!(pump(-2.1), [feeds]);
}

#[test]
fn a_mode_that_does_not_vibrate() {
    let model = with_law("{ polynomial_spring = { terms = [{ power = 3, coefficient = 2e8 }] } }")
        .replace("ratios = [{ modes = \"1\", ratio = 1e-2 }]", "rayleigh = { mass = 1596, stiffness = 0 }");
    let (warnings, text) = checked(&model, "0.2", &[]);
    let why = "mode 1 is overdamped (ratio 7.98): no resonance, no backbone; are the units of the damping right?";
    assert_eq!(warnings, [why], "{text}");
    // A backbone of responses in quadrature with the forcing needs no free motion.
    let (warnings, text) = checked(&model, "0.2", &[("backbone.equation", "\"phase_resonance\"")]);
    assert!(!warnings.iter().any(|warning| warning.contains("overdamped")), "{text}");
}

#[test]
fn a_damping_ratio_that_may_be_one_in_percent() {
    let damped = |ratio: &str| {
        let law = with_law("{ polynomial_spring = { terms = [{ power = 3, coefficient = 2e8 }] } }");
        let (warnings, _) = checked(&law.replace("ratio = 1e-2", &format!("ratio = {ratio}")), "20", &[]);
        warnings.into_iter().filter(|warning| warning.contains("ratio")).collect::<Vec<_>>()
    };
    assert_eq!(
        damped("0.5"),
        ["mode 1 has a damping ratio of 0.5, which is a lot: ratios are shares of 1, not percent"]
    );
    assert_eq!(damped("0.1"), [] as [&str; 0]);
}

/// Two masses on a spring between them, which nothing but this holds.
#[test]
fn a_structure_that_may_be_anywhere() {
    let held = |by: &str| {
        let model = format!(
            "name = \"pair\"\ndofs = [\"p\", \"q\"]\nmonitors = [\"q\"]\n[matrices]\nmass = [[1, 0], [0, 1]]\n\
             stiffness = [[1, -1], [-1, 1]]\ndamping = [[0.02, -0.02], [-0.02, 0.02]]\n[forcing]\nshape = {{ dofs = {{ p = 1 }} }}\n\
             [[laws]]\nname = \"law\"\n{by}\n"
        );
        let (warnings, _) = checked(&model, "1", &[("backbone.modes", "[2]")]);
        warnings.into_iter().filter(|warning| warning.contains("rigid-body motion")).collect::<Vec<_>>()
    };
    let spring = "law = { polynomial_spring = { terms = [{ power = 3, coefficient = 1 }] } }";
    assert_eq!(held(&format!("dof = \"q\"\n{spring}")), [] as [&str; 0]);
    // A stop, pressed at rest or not, a slider, and a spring between the two.
    let others = [
        "dof = \"q\"\nlaw = { penalty_spring = { stiffness = 0.5, gap = -0.3 } }".into(),
        "dof = \"q\"\nlaw = { jenkins = { stiffness = 0.5, limit = 0.3 } }".into(),
        format!("between = [\"q\", \"p\"]\n{spring}"),
    ];
    for by in others {
        let [warning] = &held(&by)[..] else { panic!("{by}") };
        assert!(warning.starts_with("not every rigid-body motion of mode 1 is resisted at every place: "), "{warning}");
    }
}

/// Two masses that nothing holds but laws: of one spring both feel something, whatever the modes are.
#[test]
fn masses_that_one_spring_cannot_hold() {
    let law = |place: &str| {
        format!(
            "[[laws]]\nname = \"{}\"\n{place}\nlaw = {{ polynomial_spring = {{ terms = [{{ power = 3, coefficient = 1 }}] }} }}\n",
            place.len()
        )
    };
    let warned = |laws: &[&str]| {
        let laws: String = laws.iter().map(|place| law(place)).collect();
        let model = format!(
            "name = \"three\"\ndofs = [\"p\", \"q\", \"r\"]\nmonitors = [\"r\"]\n[matrices]\n\
             mass = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nstiffness = [[0, 0, 0], [0, 0, 0], [0, 0, 1]]\n\
             damping = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]\n[forcing]\nshape = {{ dofs = {{ r = 1 }} }}\n{laws}"
        );
        let (warnings, _) = checked(&model, "1", &[("backbone.modes", "[3]")]);
        warnings.iter().any(|warning| warning.starts_with("not every rigid-body motion of modes 1 and 2 is resisted"))
    };
    assert!(warned(&["between = [\"p\", \"q\"]"]));
    assert!(warned(&["between = [\"p\", \"r\"]"]));
    assert!(!warned(&["between = [\"p\", \"q\"]", "dof = \"p\""]));
}

/// A tip that rotates on a circle hardly wider than its gap slides back while it presses.
#[test]
fn sliding_that_turns_round() {
    let told = |radius: &str, quadrature: &str| {
        let node = format!("normal = \"x\"\ntangential = [{{ x = 0.1 }}]\nradius = {radius}\nfriction = 0.2\n");
        let model = MODEL.replace("normal = \"x\"\n", &node);
        checked(&model, "0.3", &[("harmonics.quadrature", quadrature)]).0
    };
    let [warning] = &told("5e-3", "\"arcs\"")[..] else { panic!("no warning, or several") };
    assert!(warning.starts_with("`stop`: its radius, 0.005 m, is less than 10 times the gap, 0.001 m: "), "{warning}");
    assert_eq!(told("5e-3", "\"samples\""), [] as [&str; 0]);
    assert_eq!(told("0.25", "\"arcs\""), [] as [&str; 0]);
}

/// A dashpot that holds one of two masses: what is left oscillates with hardly any damping, though every mode alone has much.
#[test]
fn a_dashpot_that_couples_modes() {
    let structure = "dofs = [\"x\", \"y\"]\n[matrices]\nmass = [[1, 0], [0, 1]]\nstiffness = [[1.5e4, -5e3], [-5e3, 1.5e4]]\n\
                     damping = [[400, 0], [0, 5]]\n[forcing]\nshape = { dofs = { x = 1 } }\n";
    let (warnings, text) = checked(&format!("name = \"dashpot\"\n{structure}"), "0.5", &[]);
    assert!(
        text.contains(
            "damping ratio 0.0377284; it oscillates at 122.637 rad/s, since the damping couples modes  followed\n"
        ),
        "{text}"
    );
    assert!(
        text.contains("22.5079 Hz  does not oscillate\n")
            && text.contains("; not mode 2 (overdamped: it does not oscillate)"),
        "{text}"
    );
    let [overdamped, _nothing_nonlinear] = &warnings[..] else { panic!("{text}") };
    assert!(overdamped.starts_with("mode 2 does not oscillate, since damping couples it with others: "), "{text}");
}

/// A mass that is driven away faster than its spring pulls it back is not overdamped, nor coupled with anything.
#[test]
fn damping_below_minus_the_critical_one() {
    let model = MODEL
        .replace("[damping]\nratios = [{ modes = \"1\", ratio = 1e-2 }]\n", "")
        .replace("[[1e4]]", "[[1e4]]\ndamping = [[-300]]");
    let (warnings, text) = checked(&model, "0.5", &[]);
    let why = "mode 1 does not oscillate, since its damping is negative (ratio -1.5): no resonance, no backbone; are the units of the damping right?";
    assert!(warnings.iter().any(|warning| warning == why), "{text}");
}
