//! What marching says of a branch comes back, and stands in tables.

use super::*;
use crate::store::{PeakOrbit, Stability};
use solver::response::task::Brought;
use solver::stability::multipliers::Verdict;
use solver::stability::verification::VerifiedPoint;

#[test]
fn a_verification_comes_back_bit_for_bit_and_stands_in_tables() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, results) = study.finished(dir.path());
    let isola = results.iter().find(|result| result.name == Some(BranchId::isola(0))).unwrap();
    assert_eq!(store.verification(isola.task.as_str()).unwrap(), None);
    let verification = study.verify(&mut store, isola);

    let store = Reader::open(dir.path()).unwrap();
    assert_eq!(store.verification(isola.task.as_str()).unwrap().as_ref(), Some(&verification));
    let (level, name, _) = store.levels().unwrap().remove(1);
    assert_eq!(name, "0.006");
    let rows = store.branches(level).unwrap();
    assert_eq!(rows[0].stability, None, "the main branch was not verified");
    let (stable, unstable) = (verification.share(Verdict::Stable), verification.share(Verdict::Unstable));
    assert!(stable > 0.2 && unstable > 0.1, "{stable} {unstable}");
    let peak = verification.at_peak().and_then(|point| point.orbit.as_ref()).unwrap();
    let peak = Some(PeakOrbit { verdict: "stable".into(), at: Some((peak.omega, peak.amplitudes[0])) });
    // Its peak is stable, and no stable orbit is larger.
    let stable_orbits = verification.points.iter().filter(|point| point.verdict == Verdict::Stable);
    let sizes =
        stable_orbits.filter_map(|point| Some((point.orbit.as_ref()?.omega, point.orbit.as_ref()?.amplitudes[0])));
    let largest = sizes.max_by(|a, b| a.1.total_cmp(&b.1));
    assert_eq!(peak.as_ref().unwrap().at, largest);
    let is_marginal_in_parts = verification.share(Verdict::Marginal) > 0.0;
    let stability = Stability { is_whole: true, stable, unstable, is_marginal_in_parts, sampled: None, peak, largest };
    assert_eq!(rows[1].stability, Some(stability));
    // An isola turns at two folds, and nothing else happens to this one.
    let found = store.bifurcations().unwrap();
    let kinds: Vec<(&str, &str, &str)> =
        found.iter().map(|row| (row.forcing.as_str(), row.branch.as_str(), row.kind.as_str())).collect();
    assert_eq!(kinds, [("0.006", "isola 1", "fold"); 2]);
    for row in &found {
        assert!((rows[1].omega.0 * 0.999..=rows[1].omega.1 * 1.001).contains(&row.omega), "{row:?}");
    }
    // It is no branch of its own, and leaves nothing to be done.
    assert_eq!(store.extents().unwrap().len(), results.iter().filter(|result| result.branch.is_some()).count());
    assert_eq!(store.open_tasks(level).unwrap(), (0, 0));
    assert_eq!(store.added().unwrap().len(), 1);
}

/// Of a stretch around the peak as many points are told as were marched of it; the orbit near a stable peak may be told of at another point.
#[test]
fn a_stretch_around_the_peak() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, results) = study.finished(dir.path());
    let isola = results.iter().find(|result| result.name == Some(BranchId::isola(0))).unwrap();
    let verification = study.verify(&mut store, isola);
    drop(store);
    let (count, between) = (verification.points.len(), verification.points[1].index);
    assert_ne!(between, verification.peak);
    let db = rusqlite::Connection::open(dir.path().join(FILE)).unwrap();
    let rows = || {
        let store = Reader::open(dir.path()).unwrap();
        let level = store.levels().unwrap().remove(1).0;
        store.branches(level).unwrap()
    };
    db.execute("UPDATE verifications SET stretch = 'peak'", []).unwrap();
    assert_eq!(rows()[1].stability.as_ref().unwrap().sampled, None);
    assert_eq!(db.execute("DELETE FROM verified_points WHERE i = ?1", [between]).unwrap(), 1);
    assert!(db.execute("UPDATE points SET stable = NULL WHERE i = ?1", [verification.peak]).unwrap() > 0);
    let row = rows().remove(1);
    let stability = row.stability.as_ref().unwrap();
    assert_eq!((stability.is_whole, stability.sampled), (false, Some(count - 1)));
    // Of that orbit, whatever the points of the branch say.
    assert_eq!(stability.largest, stability.peak.as_ref().unwrap().at);
}

/// What marching came to from the peak has the frequency and amplitude of the other side of the isola.
#[test]
fn an_orbit_of_another_motion_is_none_of_the_peak() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, results) = study.finished(dir.path());
    let isola = results.iter().find(|result| result.name == Some(BranchId::isola(0))).unwrap();
    let peak = study.verify(&mut store, isola).peak;
    drop(store);
    let db = rusqlite::Connection::open(dir.path().join(FILE)).unwrap();
    let sql = "UPDATE verified_points SET (omega, amplitude) = (SELECT other.omega, other.amplitude FROM points AS other \
               JOIN points AS peak ON peak.branch = other.branch AND peak.i = ?1 \
               JOIN verifications ON verifications.branch = peak.branch WHERE other.amplitude < 0.9 * peak.amplitude \
               ORDER BY abs(other.omega - peak.omega) LIMIT 1), at = i WHERE i = ?1";
    assert_eq!(db.execute(sql, [peak]).unwrap(), 1);
    let store = Reader::open(dir.path()).unwrap();
    let level = store.levels().unwrap().remove(1).0;
    let stability = store.branches(level).unwrap()[1].stability.clone().unwrap();
    assert_eq!(stability.peak, Some(PeakOrbit { verdict: "none".into(), at: None }));
}

#[test]
fn a_verification_of_another_branch_says_nothing() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, results) = study.finished(dir.path());
    let isola = results.iter().find(|result| result.name == Some(BranchId::isola(0))).unwrap();
    let main = results.iter().rfind(|result| result.name == Some(BranchId::MAIN)).unwrap();
    study.verify(&mut store, &StoredResult { branch: main.branch.clone(), ..isola.clone() });
    assert_eq!(store.verification(isola.task.as_str()).unwrap(), None);
}

#[test]
fn a_damaged_verification_is_said() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, results) = study.finished(dir.path());
    let isola = results.iter().find(|result| result.name == Some(BranchId::isola(0))).unwrap();
    study.verify(&mut store, isola);
    drop(store);
    let sql = "SELECT task, record FROM results JOIN verifications USING (task)";
    let db = rusqlite::Connection::open(dir.path().join(FILE)).unwrap();
    let (task, record): (String, Vec<u8>) = db.query_row(sql, [], |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
    let place = record.windows(2).position(|pair| pair == b"at").unwrap() + 2;
    let mut bent = record;
    bent[place] ^= 0x40;
    db.execute("UPDATE results SET record = ?1 WHERE task = ?2", rusqlite::params![bent, task]).unwrap();
    let error = Reader::open(dir.path()).unwrap().verification(isola.task.as_str()).unwrap_err();
    assert!(error.to_string().contains("run.sqlite"), "{error}");
}

#[test]
fn what_is_to_be_verified_can_be_changed_afterwards() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, _) = study.finished(dir.path());
    assert_eq!(store.header().unwrap(), study.header());
    store.set_verify(VerifyEffort::All).unwrap();
    assert_eq!(store.header().unwrap().settings.verify.effort, VerifyEffort::All);
}

#[test]
fn what_unstable_motions_turn_into_comes_back_and_stands_in_tables() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, results) = study.finished(dir.path());
    let isola = results.iter().find(|result| result.name == Some(BranchId::isola(0))).unwrap();
    let verification = study.verify(&mut store, isola);
    let unstable = verification.points.iter().filter(|point| point.verdict == Verdict::Unstable);
    let growth = |point: &&VerifiedPoint| point.orbit.as_ref().unwrap().multipliers[0].modulus();
    // Beside a fold a motion leaves so slowly that nobody waits for it.
    let unstable = unstable.max_by(|a, b| growth(a).total_cmp(&growth(b))).unwrap();
    let settling = study.march(&mut store, isola, unstable.index);
    // What separates lets the structure go, here upwards.
    let motion = settling.motion.map(|motion| motion.to_string());
    assert_eq!((motion, settling.onto), (Some("period 1".into()), Some(BranchId::isola(0))));

    let store = Reader::open(dir.path()).unwrap();
    assert_eq!(store.settlings(isola.task.as_str()).unwrap(), std::slice::from_ref(&settling));
    let rows = store.motions().unwrap();
    let row = &rows[0];
    assert_eq!(
        (rows.len(), row.branch.as_str(), row.motion.as_str(), row.repeats),
        (1, "isola 1", "periodic", Some(1))
    );
    assert_eq!(row.amplitude, Some((settling.amplitudes[0][0], settling.amplitudes[0][1])));
    let orbit = unstable.orbit.as_ref().unwrap();
    assert!(row.amplitude.unwrap().1 > 1.01 * orbit.amplitudes[0], "{row:?} from {orbit:?}");
    // What follows from a verification is known to a run that goes on.
    let tasks = store.tasks().unwrap();
    assert!(tasks.iter().any(|task| matches!(task.brought, Some(Brought::Verification(..)))));
    assert_eq!(store.added().unwrap().len(), 2);
}
