//! Names and keys: nothing that is not one plain chunk of a key becomes part of one.

use proptest::prelude::*;
use protocol::ids::{RunId, TaskId, WorkerId};
use protocol::keys::{Keys, NAMESPACE, all_runs, all_versions, last_chunk};

const REFUSED: [&str; 22] = [
    "", " ", "a b", "a/b", "/a", "a/", "*", "**", "a*", "$*", "a$*", "#", "?", "a?b", "@", "@a", "a\n", "a\0", "ä",
    "a:b", "a\\b", "a,b",
];

#[test]
fn names_that_are_not_one_chunk_are_refused() {
    let long = "a".repeat(101);
    for name in REFUSED.into_iter().chain([long.as_str()]) {
        let error = RunId::new(name).unwrap_err();
        assert!(error.to_string().contains("is not a name: use letters, digits"), "{error}");
        assert!(error.to_string().contains(name), "{error}");
        assert!(TaskId::new(name).is_err() && WorkerId::new(name).is_err(), "{name:?}");
        assert!(name.parse::<TaskId>().is_err() && WorkerId::try_from(name.to_string()).is_err(), "{name:?}");
    }
    for name in ["a", "A-1", "2.5e-3", "run_2", &"a".repeat(100)] {
        assert_eq!(RunId::new(name).unwrap().as_str(), name);
    }
}

#[test]
fn tasks_are_named_by_amplitude_and_number() {
    assert_eq!(TaskId::of_level("2.5", 0).unwrap().as_str(), "2.5-0");
    assert_eq!(TaskId::of_level("1e+3", 12).unwrap().as_str(), "1e3-12");
    for amplitude in ["2/5", "2,5", "*", "2 5"] {
        assert!(TaskId::of_level(amplitude, 0).is_err(), "{amplitude}");
    }
}

#[test]
fn keys_are_those_documented() {
    let run = RunId::new("damper-1").unwrap();
    let task = TaskId::new("2.5-3").unwrap();
    let worker = WorkerId::new("host-77").unwrap();
    let keys = Keys::new(NAMESPACE, &run);
    let documented = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/MESSAGES.md")).unwrap();
    for (key, name) in [
        (keys.run(), "run"),
        (keys.model(), "model"),
        (keys.backbone(), "backbone"),
        (keys.backbone_of(2), "backbone/<mode>"),
        (keys.backbones(), "backbone/*"),
        (keys.windows(), "windows"),
        (keys.seed(&task), "seed/<task>"),
        (keys.seeds(), "seed/*"),
        (keys.done(&task), "done/<task>"),
        (keys.all_done(), "done/*"),
        (keys.result(&task), "result/<task>"),
        (keys.results(), "result/*"),
        (keys.status(), "status"),
        (keys.progress(&task), "progress/<task>"),
        (keys.lease(), "rpc/lease"),
        (keys.renew(), "rpc/renew"),
        (keys.submit(&task), "rpc/submit/<task>"),
        (keys.keep(&task), "rpc/checkpoint/<task>"),
        (keys.checkpoint(&task), "checkpoint/<task>"),
        (keys.fail(), "rpc/fail"),
        (keys.release(), "rpc/release"),
        (keys.control(), "rpc/control"),
        (keys.hint(), "ctl/hint"),
        (keys.wake(&worker), "ctl/wake/<worker>"),
        (keys.alive_coordinator(), "alive/coordinator"),
        (keys.alive_worker(&worker), "alive/worker/<worker>"),
        (keys.alive_workers(), "alive/worker/*"),
    ] {
        let filled = name.replace("<task>", task.as_str()).replace("<worker>", worker.as_str()).replace("<mode>", "2");
        assert_eq!(key, format!("isola/v13/damper-1/{filled}"));
        assert!(documented.contains(&format!("`{name}`")), "{name} is not in MESSAGES.md");
        zenoh::key_expr::KeyExpr::try_from(key.as_str()).unwrap();
        assert!(zenoh::key_expr::KeyExpr::autocanonize(key.clone()).is_ok_and(|canon| canon.as_str() == key));
    }
    assert_eq!(last_chunk(&keys.done(&task)), task.as_str());
    let steps = keys.checkpoint_from(&task, 17);
    let asked = zenoh::query::Selector::try_from(steps.as_str()).unwrap();
    assert_eq!((asked.key_expr().as_str(), asked.parameters().get("first")), (&*keys.checkpoint(&task), Some("17")));
}

#[test]
fn wildcards_meet_what_they_are_for() {
    let key = |text: &str| zenoh::key_expr::KeyExpr::try_from(text.to_string()).unwrap();
    let keys = Keys::new(NAMESPACE, &RunId::new("a").unwrap());
    let task = TaskId::new("1-0").unwrap();
    assert!(key(&all_runs(NAMESPACE)).includes(&key(&keys.run())));
    assert!(key(&all_versions(NAMESPACE)).includes(&key(&keys.run())));
    assert!(key(&all_versions(NAMESPACE)).includes(&key("isola/v2/b/run")));
    assert!(!key(&all_runs(NAMESPACE)).intersects(&key("isola/v99/b/run")));
    for request in
        [keys.lease(), keys.renew(), keys.submit(&task), keys.keep(&task), keys.fail(), keys.release(), keys.control()]
    {
        assert!(key(&keys.requests()).includes(&key(&request)));
    }
    assert!(!key(&keys.requests()).intersects(&key(&keys.result(&task))));
    assert!(!key(&keys.all_done()).intersects(&key(&keys.result(&task))));
}

proptest! {
    #[test]
    fn any_name_is_refused_or_is_one_chunk_that_zenoh_takes(name in "\\PC{0,12}|[a-zA-Z0-9._/*$#?@-]{0,12}") {
        if let Ok(id) = RunId::new(&name) {
            let key = Keys::new(NAMESPACE, &id).run();
            prop_assert_eq!(key.split('/').nth(2), Some(name.as_str()));
            prop_assert!(zenoh::key_expr::KeyExpr::try_from(key).is_ok());
        }
    }
}
