//! The solver's nouns through messages and bytes, without loss; arrays that do not fit are errors, never panics.

use crate::samples::{self, SIZE};
use proptest::prelude::*;
use protocol::array::{Array, ArrayError};
use protocol::backbone::BackboneMessage;
use protocol::branch::{BranchMessage, TaskResultMessage};
use protocol::codec::{Message, decode, decode_stored, encode, encoding};
use protocol::curve::{Points, Seeds, Size};
use protocol::from_worker::{CheckpointRequest, Lease, SubmitRequest};
use protocol::ids::{Attempt, TaskId, WorkerId};
use protocol::model::ModelMessage;
use protocol::steps::Steps;
use protocol::to_everyone::StoredResult;
use protocol::to_worker::Grant;
use solver::files;
use solver::formulation::modal::Modal;
use solver::response::backbone::Backbone;
use solver::response::branch::{Branch, SpecialKind, SpecialPoint};
use solver::response::columns;
use solver::response::level::Level;
use solver::response::task::{TaskResult, plan};
use solver::settings::{FrequencySettings, Settings};
use solver::structure::Model;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::LazyLock;

fn load(name: &str) -> Model {
    files::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name)).unwrap()
}

fn through_bytes<M: Message>(message: &M) -> M {
    decode(&encode(message), &encoding::<M>()).unwrap()
}

/// Exact to the last bit, the sign of zero included: numbers are printed so that they can be read back.
fn assert_identical(a: &impl std::fmt::Debug, b: &impl std::fmt::Debug) {
    assert!(format!("{a:?}") == format!("{b:?}"));
}

/// Backbone and one level with an isola.
struct Damper {
    model: Model,
    size: Size,
    backbone: Backbone,
    level: Level,
}

const AMPLITUDE: f64 = 0.008;

static DAMPER: LazyLock<Damper> = LazyLock::new(|| {
    let model = load("nonlinear_damper");
    let mut settings = Settings::default();
    settings.harmonics.count = 3;
    settings.backbone.max_amplitude = Some(3.0);
    let mut observer = |_: &_| ControlFlow::Continue(());
    let backbone = Backbone::compute_with(&model, &settings, &mut observer).unwrap();
    let level = Level::compute_with(&model, &settings, &backbone, AMPLITUDE, &mut observer).unwrap();
    assert_eq!(level.isolas().count(), 1);
    let size = Size::of(&model);
    Damper { model, size, backbone, level }
});

#[test]
fn models() {
    for name in ["rotor67", "nltva", "nonlinear_damper", "friction_mass", "cantilever_stop", "two_masses_stop"] {
        let model = load(name);
        let message = ModelMessage::from(&model);
        let read = through_bytes(&message);
        assert_eq!(read, message, "{name}");
        assert_identical(&read.model().unwrap(), &model);
    }
}

#[test]
fn backbone() {
    let damper = &*DAMPER;
    let message = BackboneMessage::from(&damper.backbone);
    assert!(message.points.len() > 10);
    let backbone = through_bytes(&message).backbone(&damper.size).unwrap();
    assert_eq!(backbone, damper.backbone);
    assert_identical(&backbone, &damper.backbone);
}

#[test]
fn branches() {
    let damper = &*DAMPER;
    for (_, branch) in damper.level.branches() {
        let submit = SubmitRequest {
            lease: Lease {
                task: TaskId::of_level("0.008", 0).unwrap(),
                attempt: Attempt(1),
                worker: WorkerId::new("w").unwrap(),
                slot: 0,
            },
            program: protocol::PROGRAM.into(),
            seconds: 0.5,
            next: false,
            orbits: None,
            finding: (&TaskResult::Branch(branch.clone())).into(),
        };
        let TaskResultMessage::Branch(message) = through_bytes(&submit).finding else { panic!("a branch was sent") };
        let stored = StoredResult { branch: Some(message), ..samples::result() };
        let read = through_bytes(&stored).branch.unwrap().branch(&damper.size).unwrap();
        assert_eq!(&read, branch);
        assert_identical(&read, branch);
        for column in columns::of_points() {
            let array = stored.branch.as_ref().unwrap().points.columns.get(column.name).unwrap();
            let values = branch.column(column.name).unwrap();
            assert_eq!(values.len(), branch.points.len());
            assert_eq!(array.values(column.name, &array.shape).unwrap(), values.concat());
        }
        assert!(branch.column("nothing").is_none());
    }
}

#[test]
fn contact_on_a_branch() {
    let model = load("cantilever_stop");
    let settings = Settings::default();
    let mut points = 0;
    let mut observer = |_: &_| {
        points += 1;
        if points < 60 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let backbone = Backbone::compute_with(&model, &settings, &mut observer).unwrap();
    let message = BackboneMessage::from(&backbone);
    assert_eq!(message.points.columns.get("contact").unwrap().shape, [backbone.points.len(), 1]);
    assert!(backbone.points.iter().any(|point| point.point.contact()[0] > 0.0));
    assert_eq!(through_bytes(&message).backbone(&Size::of(&model)).unwrap(), backbone);
}

#[test]
fn seeds() {
    let damper = &*DAMPER;
    let modal = Modal::new(&damper.model);
    let (_, tasks) = plan(&damper.backbone, AMPLITUDE, &FrequencySettings::default(), 1);
    assert!(tasks.len() > 2);
    for task in tasks {
        let seeds = task.seeds(&modal, &damper.backbone, AMPLITUDE);
        let read: Seeds = rmp_serde::from_slice(&rmp_serde::to_vec_named(&Seeds::new(&seeds)).unwrap()).unwrap();
        assert_eq!(read.seeds(&damper.size).unwrap(), seeds);
    }
}

#[test]
fn a_model_of_another_size_is_refused() {
    let damper = &*DAMPER;
    let message = BranchMessage::from(damper.level.main());
    let right = damper.size;
    for wrong in [
        Size { channels: right.channels + 1, ..right },
        Size { modes: right.modes + 1, ..right },
        Size { monitors: right.monitors + 1, ..right },
        Size { contacts: right.contacts + 1, ..right },
        Size { channels: usize::MAX, modes: usize::MAX, monitors: usize::MAX, contacts: usize::MAX },
        Size { channels: 0, modes: 0, monitors: 0, contacts: 0 },
    ] {
        let error = message.branch(&wrong).unwrap_err();
        assert!(matches!(error, ArrayError::Shape { .. }), "{error}");
        assert!(BackboneMessage::from(&damper.backbone).backbone(&wrong).is_err());
    }
}

/// An array of points.
fn array<'b>(branch: &'b mut BranchMessage, name: &str) -> &'b mut Array {
    let Points { motions, columns } = &mut branch.points;
    match name {
        "omega" => &mut motions.omega,
        "decay" => &mut motions.decay,
        "forcing" => &mut motions.forcing,
        "argument" => &mut motions.argument,
        "modal" => &mut motions.modal,
        column => columns.get_mut(column).unwrap(),
    }
}

#[test]
fn arrays_that_do_not_fit_are_named() {
    assert_eq!(Size::of(&samples::model().model().unwrap()), SIZE);
    samples::branch().branch(&SIZE).unwrap();
    samples::backbone().backbone(&SIZE).unwrap();
    let motions = ["omega", "decay", "forcing", "argument", "modal"].into_iter();
    for name in motions.chain(columns::of_points().map(|column| column.name)) {
        let damages: [fn(&mut Array); 8] = [
            |a| a.dtype = "<f4".into(),
            |a| a.dtype = ">f8".into(),
            |a| a.data.truncate(a.data.len() - 1),
            |a| a.data.extend([0; 8]),
            |a| a.shape.push(1),
            |a| a.shape[0] += 1,
            |a| a.shape = vec![usize::MAX, usize::MAX],
            |a| (a.shape, a.data) = (Vec::new(), Vec::new()),
        ];
        for damage in damages {
            let mut branch = samples::branch();
            damage(array(&mut branch, name));
            // The number of points is that of ω: if it is wrong another array may be the first that does not fit.
            let error = branch.branch(&SIZE).unwrap_err().to_string();
            assert!(error.contains(&format!("`{name}`")) || name == "omega", "{name}: {error}");
        }
    }
}

#[test]
fn harmonics_that_overflow_are_errors() {
    for harmonics in [0, 2, usize::MAX, usize::MAX - 1, usize::MAX / 2, usize::MAX / 2 - 1, usize::MAX / 4 + 1] {
        let mut branch = samples::branch();
        branch.points.motions.harmonics = harmonics;
        assert!(branch.branch(&SIZE).is_err(), "{harmonics}");
        // No points: no numbers, whatever the other axes.
        let none = Array::new([0], []);
        let motions = &mut branch.points.motions;
        (motions.omega, motions.decay, motions.forcing) = (none.clone(), none.clone(), none.clone());
        for (array, axis) in [(&mut motions.argument, SIZE.channels), (&mut motions.modal, SIZE.modes)] {
            *array =
                Array { dtype: "<f8".into(), shape: vec![0, axis, harmonics.wrapping_add(1), 2], data: Vec::new() };
        }
        for (_, array) in branch.points.columns.iter_mut() {
            array.shape[0] = 0;
            array.data.clear();
        }
        assert!(branch.branch(&SIZE).is_err(), "{harmonics}");
    }
}

#[test]
fn special_points_that_do_not_exist_are_errors() {
    let mut branch = samples::branch();
    branch.special.push(SpecialPoint { kind: SpecialKind::Fold, index: 2 });
    let error = branch.branch(&SIZE).unwrap_err();
    assert!(error.to_string().contains("special point 2"), "{error}");
}

#[test]
fn models_that_do_not_fit_are_errors() {
    samples::model().model().unwrap();
    let damages: [fn(&mut ModelMessage); 12] = [
        |m| m.mass.dtype = "<f4".into(),
        |m| m.stiffness.shape = vec![4],
        |m| m.shapes.data.truncate(31),
        |m| m.frequencies = Array::new([3], [1.0, 2.0, 3.0]),
        |m| m.forcing = Array::new([1], [1.0]),
        |m| m.damping = Array::new([1, 1], [1.0]),
        |m| m.damping.shape = Vec::new(),
        |m| m.dofs.clear(),
        |m| m.dofs.push("third".into()),
        |m| m.monitors.clear(),
        |m| m.monitors.push(2),
        |m| m.elements[0].channels[0][0].0 = 2,
    ];
    for (number, damage) in damages.into_iter().enumerate() {
        let mut message = samples::model();
        damage(&mut message);
        assert!(message.model().is_err(), "{number}");
    }
    let mut message = samples::model();
    message.elements[0].channels.pop();
    let error = message.model().unwrap_err().to_string();
    assert!(error.contains("`elements.node.channels` = 2"), "{error}");
}

/// Series of the same length, several of them.
fn many_series() -> impl Strategy<Value = (usize, Vec<Vec<f64>>)> {
    (0usize..6).prop_flat_map(|harmonics| {
        let one = proptest::collection::vec(any::<f64>(), 2 * harmonics + 1);
        (Just(harmonics), proptest::collection::vec(one, 0..5))
    })
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

proptest! {
    #[test]
    fn series_are_harmonics_and_back((harmonics, series) in many_series()) {
        let leading = [series.len()];
        let array = Array::harmonics(&leading, harmonics, series.iter().map(Vec::as_slice));
        prop_assert_eq!(&array.shape, &vec![series.len(), harmonics + 1, 2]);
        let values = array.values("series", &array.shape).unwrap();
        for (one, pairs) in series.iter().zip(values.chunks(2 * (harmonics + 1))) {
            prop_assert_eq!([pairs[0].to_bits(), pairs[1].to_bits()], [one[0].to_bits(), 0]);
            for k in 1..=harmonics {
                // X_k = a_k − i b_k.
                prop_assert_eq!(pairs[2 * k].to_bits(), one[2 * k - 1].to_bits());
                prop_assert_eq!(pairs[2 * k + 1].to_bits(), (-one[2 * k]).to_bits());
            }
        }
        let back = array.series("series", &leading, harmonics).unwrap();
        prop_assert_eq!(bits(&back), bits(&series.concat()));
        let read: Array = rmp_serde::from_slice(&rmp_serde::to_vec_named(&array).unwrap()).unwrap();
        prop_assert_eq!((read.shape, read.data), (array.shape, array.data));
    }

    #[test]
    fn any_shape_and_bytes_are_values_or_an_error(
        shape in proptest::collection::vec(prop_oneof![0usize..5, any::<usize>()], 0..4),
        expected in proptest::collection::vec(prop_oneof![0usize..5, any::<usize>()], 0..4),
        same in any::<bool>(),
        bytes in 0usize..200,
        harmonics in prop_oneof![0usize..5, any::<usize>()],
    ) {
        let expected = if same { shape.clone() } else { expected };
        let array = Array { dtype: "<f8".into(), shape, data: vec![1; bytes] };
        if let Ok(values) = array.values("any", &expected) {
            prop_assert_eq!(values.len() * 8, bytes);
        }
        let _ = array.series("any", &expected, harmonics);
    }

    #[test]
    fn any_bytes_are_a_message_or_an_error(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = decode_stored::<ModelMessage>(&bytes).is_ok_and(|message| message.model().is_ok());
        let _ = decode_stored::<BackboneMessage>(&bytes).is_ok_and(|message| message.backbone(&SIZE).is_ok());
        let _ = decode_stored::<StoredResult>(&bytes);
        let _ = decode_stored::<SubmitRequest>(&bytes);
    }

    #[test]
    fn a_bent_result_is_a_branch_or_an_error(
        bends in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut bytes = encode(&samples::result());
        for (place, byte) in bends {
            let index = place.index(bytes.len());
            bytes[index] = byte;
        }
        if let Ok(StoredResult { branch: Some(message), .. }) = decode_stored(&bytes)
            && let Ok(branch) = message.branch(&SIZE)
        {
            prop_assert_eq!(branch.peak().amplitudes().len(), 1);
            for kind in [SpecialKind::Start, SpecialKind::Peak, SpecialKind::Fold, SpecialKind::BranchPoint] {
                prop_assert!(Branch::special(&branch, kind).count() <= branch.special.len());
            }
        }
    }
}

#[test]
fn steps_keep_every_bit() {
    let steps = samples::walked();
    let message = Steps::new("0f".into(), 7, &steps);
    assert_eq!((message.len(), message.first, message.is_empty()), (2, 7, false));
    let request = CheckpointRequest { lease: samples::lease(), steps: message.clone() };
    assert_identical(&through_bytes(&request).steps.steps().unwrap(), &steps);
    // What is of another length is another message's.
    let mut other = steps.clone();
    other[1].memory.push(0.5);
    assert_identical(&Steps::new("0f".into(), 7, &other).steps().unwrap(), &vec![other[0].clone()]);
    assert_identical(&Steps::new("0f".into(), 7, &[]).steps().unwrap(), &[(); 0]);
    let damage: [fn(&mut Steps); 6] = [
        |steps| steps.walk.truncate(1),
        |steps| steps.rejections.push(1),
        |steps| steps.is_narrow.clear(),
        |steps| steps.state = Array::new([2, 1], [0.0, f64::NAN]),
        |steps| steps.tangent.shape = vec![2, usize::MAX],
        |steps| steps.longest_step.data.truncate(3),
    ];
    for damage in damage {
        let mut damaged = message.clone();
        damage(&mut damaged);
        assert!(damaged.steps().is_err());
    }
}

/// Only what steps depend on tells checkpoints apart.
#[test]
fn a_fingerprint_is_of_what_steps_depend_on() {
    let grant = samples::grant();
    let later = Grant { attempt: Attempt(7), ttl_ms: 1, checkpoint: 99, ..grant.clone() };
    assert_eq!(later.fingerprint(), grant.fingerprint());
    let mut others = vec![grant.clone(); 4];
    others[0].amplitude = 2.25;
    others[1].known.pop();
    others[2].reach.frequency.1 = 1.75;
    others[3].landing = None;
    assert!(others.iter().all(|other| other.fingerprint() != grant.fingerprint()));
}
