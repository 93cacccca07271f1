//! The page is given what files are drawn from.

use super::data::PageData;
use crate::fixture::Study;
use crate::plot::{FigureName, Request, compose};
use crate::report::{Report, Selection};
use serde_json::{Value, json};
use tempfile::tempdir;

/// The JSON of the page, and where the run is.
fn page(study: &Study) -> (Value, crate::store::Store, tempfile::TempDir) {
    let dir = tempdir().unwrap();
    let (store, _) = study.finished(dir.path());
    let report = Report::read(&store, &Selection::Fitting).unwrap();
    (serde_json::to_value(PageData::new(&report, &[])).unwrap(), store, dir)
}

/// Takes out what files have besides: the motion that time marching has at the point, which the page does not march.
fn without_marched(figure: &mut Value) {
    let legend = figure["legend"].as_array_mut().unwrap();
    let entry = legend.pop().unwrap();
    assert!(entry["text"].as_str().unwrap().starts_with("marched in time"), "{entry}");
    let series = figure["panels"][0]["series"].as_array_mut().unwrap();
    let count = series.len();
    series.retain(|series| series["style"] != entry["style"]);
    assert!(series.len() < count);
}

#[test]
fn page_and_file_are_of_one_description() {
    let (page, store, _dir) = page(&Study::damper());
    for figure in FigureName::ALL.into_iter().filter(|figure| !matches!(figure, FigureName::Modes | FigureName::Folds))
    {
        let request = Request::whole(figure);
        let (sheet, _) = compose(&store, &request).unwrap();
        let told = &page["figures"][figure.name()];
        let mut drawn = serde_json::to_value(&sheet.figure).unwrap();
        if figure == FigureName::Motion {
            without_marched(&mut drawn);
        }
        let mut entries = told["legend"].as_array().unwrap().clone();
        if figure == FigureName::Map {
            // No amplitude is chosen in a file.
            let chosen: Vec<Value> = entries.splice(1..3, []).collect();
            assert!(chosen[0]["text"].as_str().unwrap().starts_with("amplitude chosen"), "{chosen:?}");
            assert!(chosen[1]["text"].as_str().unwrap().starts_with("windows there"), "{chosen:?}");
        }
        assert_eq!(Value::Array(entries), drawn["legend"], "{figure}");
        for (told, drawn) in told["panels"].as_array().unwrap().iter().zip(drawn["panels"].as_array().unwrap()) {
            let part = if figure == FigureName::Motion { "spans" } else { "labels" };
            assert_eq!(told[part], drawn[part], "{figure}");
            let looks = |panel: &Value| {
                let series = panel["series"].as_array().unwrap().iter();
                let looks = series.map(|series| json!([series["name"], series["style"], series["kind"]]));
                looks.collect::<Vec<Value>>()
            };
            assert_eq!(looks(told), looks(drawn), "{figure}");
            assert_eq!(told["x"], drawn["x"], "{figure}");
        }
    }
    let why = page["nothing"]["modes"].as_str().unwrap();
    assert_eq!(why, "one mode alone makes the backbone");
    assert_eq!(page["nothing"]["folds"], "the run has no fold curve");
    assert_eq!(page["palette"]["light"]["ramp"][0], "#e08a2e");
}

#[test]
fn the_page_begins_in_the_units_of_the_run() {
    let dir = tempdir().unwrap();
    let (store, _) = Study::new("two_masses_stop", 3, &["0.02"]).finished(dir.path());
    let mut report = Report::read(&store, &Selection::Fitting).unwrap();
    let told = |report: &Report| {
        let page = serde_json::to_value(PageData::new(report, &[])).unwrap();
        let unit = |panel: usize, figure: &str| page["figures"][figure]["panels"][panel]["y"][0]["unit"].clone();
        let of_motion = page["motions"]["points"][0]["panels"][0]["unit"]["name"].clone();
        // Frequencies are turned by the page.
        assert_eq!(page["figures"]["response"]["panels"][0]["x"][0]["unit"]["name"], "rad/s");
        (page["frequency_unit"].clone(), unit(0, "response"), unit(1, "resonance"), of_motion)
    };
    let (frequency, ..) = told(&report);
    assert_eq!(frequency, "rad/s");
    report.account.study = "units = 'um,Hz'".into();
    let micrometres = json!({ "name": "µm", "factor": 1e6 });
    assert_eq!(told(&report), (json!("Hz"), micrometres.clone(), micrometres, json!("µm")));
}

#[test]
fn labels_have_places_at_every_width() {
    let (page, ..) = page(&Study::damper());
    let panel = &page["figures"]["response"]["panels"][0];
    let placements = panel["placements"].as_array().unwrap();
    assert_eq!(placements.len(), 6);
    let count = panel["labels"].as_array().unwrap().len();
    for placement in placements {
        let spots = placement["spots"].as_array().unwrap();
        assert!((1..=count).contains(&spots.len()));
        assert!(spots.iter().all(|spot| (spot[0].as_u64().unwrap() as usize) < count));
    }
    let frames = page["frames"].as_array().unwrap();
    let first = &frames[page["first_frame"].as_u64().unwrap() as usize];
    assert_eq!(first["name"], "A = 0.006");
    let names: Vec<&str> = first["runs"].as_array().unwrap().iter().map(|run| run["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["main", "isola 1"]);
    let amplitudes: Vec<f64> = frames.iter().map(|frame| frame["amplitude"].as_f64().unwrap()).collect();
    assert!(amplitudes.is_sorted() && amplitudes.contains(&3e-3));
    let places = &page["figures"]["balance"]["panels"][0]["run_labels"]["frames"];
    assert_eq!(places.as_array().unwrap().len(), frames.len());
}

/// Every column is referred to, most of them several times.
#[test]
fn columns_are_shared() {
    fn refs(value: &Value, found: &mut Vec<usize>) {
        match value {
            Value::Object(map) => {
                found.extend(map.get("column").and_then(Value::as_u64).map(|column| column as usize));
                map.values().for_each(|value| refs(value, found));
            }
            Value::Array(list) => list.iter().for_each(|value| refs(value, found)),
            _ => {}
        }
    }
    let (page, ..) = page(&Study::new("two_masses_stop", 3, &["0.02"]));
    let columns = page["columns"].as_array().unwrap();
    let mut found = Vec::new();
    refs(&page["figures"], &mut found);
    assert!(found.len() > 2 * columns.len(), "{} of {}", found.len(), columns.len());
    found.sort_unstable();
    found.dedup();
    assert_eq!(found, (0..columns.len()).collect::<Vec<usize>>());
}
