"""The checker of the structure on small workspaces that are made up."""

from pathlib import Path

import check_structure
import pytest
from check_structure import SQL_FOLDER, check


def workspace(top, files, manifests=None):
    """A workspace: Rust files by their path, whose first part is the package; lines of manifests by package."""
    packages = sorted({path.split("/")[0] for path in files} | set(manifests or {}))
    (top / "Cargo.toml").write_text(f"[workspace]\nmembers = {packages}\n")
    for package in packages:
        (top / package / "src").mkdir(parents=True, exist_ok=True)
        (top / package / "Cargo.toml").write_text((manifests or {}).get(package, ""))
    for path, text in files.items():
        (top / path).parent.mkdir(parents=True, exist_ok=True)
        (top / path).write_text(text)
    return top


def crate(top, **modules):
    """A workspace of one package `k`: texts of modules by name; `a__b` is `a/b.rs`, `lib` declares the others."""
    names = sorted({name.split("__")[0] for name in modules} - {"lib", "main"})
    lib = "".join(f"pub mod {name};\n" for name in names) + modules.pop("lib", "")
    files = {f"k/src/{name.replace('__', '/')}.rs": text for name, text in modules.items()}
    return workspace(top, {"k/src/lib.rs": lib, **files})


def circles(top, exceptions=None):
    """First lines of what is wrong."""
    return [sentence.splitlines()[0] for sentence in check(top, exceptions or {})]


def of(*modules, folder="k/src"):
    """How a circle is told."""
    return f"{folder}: {', '.join(modules)} are a circle"


def test_a_circle_is_told_with_the_places_that_make_it(tmp_path):
    a = "\nuse crate::b::{self, Thing};\npub fn a() -> Thing { b::make() }\n"
    crate(tmp_path, a=a, b="pub struct Thing;\npub fn make() { crate::a::a() }\n", c="use crate::a::a;\n")
    assert check(tmp_path, {}) == [
        f"{of('a', 'b')}\n"
        "    a -> b: k/src/a.rs:2 crate::b, k/src/a.rs:2 crate::b::Thing, k/src/a.rs:3 b::make\n"
        "    b -> a: k/src/b.rs:2 crate::a::a"
    ]


def test_many_places_are_counted(tmp_path):
    crate(
        tmp_path,
        a="use crate::b::{V, W, X, Y, Z};",
        b="use crate::a;\npub struct V; struct W; struct X; struct Y; struct Z;",
    )
    assert "crate::b::X, and 2 more\n" in check(tmp_path, {})[0]


def test_chains_are_no_circles(tmp_path):
    assert (
        circles(crate(tmp_path, a="use crate::b::B; use crate::c::C;", b="use crate::c::C; struct B;", c="struct C;"))
        == []
    )


def test_circles_of_more_than_two_and_more_than_one(tmp_path):
    modules = {"a": "b", "b": "c", "c": "a", "d": "e", "e": "d", "f": "a"}
    crate(tmp_path, **{name: f"use crate::{other}::X; struct X;" for name, other in modules.items()})
    assert circles(tmp_path) == [of("a", "b", "c"), of("d", "e")]


@pytest.mark.parametrize(
    "text",
    [
        "use crate::b::B;",
        "use super::b::B;",
        "use crate::{b::{B as C}};",
        "use crate::b::*; fn f(_: B) {}",
        "use crate::b::B as _;",
        "use crate::b; fn f(_: b::B) {}",
        "pub use crate::b::B;",
        "pub(crate) use super::b::B;",
        "fn f() { crate::b::B }",
        "fn f() { use crate::b::B; }",
        "fn f() { for i in 0..crate::b::COUNT {} }",
        "impl<T: Into<crate::b::B>> A for T {}",
        "fn f() -> Vec<super::b::B> {}",
        "mod inner { use super::super::b::B; }",
        "mod inner { mod more { fn f() { super::super::super::b::B } } }",
        'fn f() { format!("{}", crate::b::B) }',
        "macro_rules! m { () => { $crate::b::B } }",
        "#[arg(value_parser = crate::b::parse)] struct A;",
        '#[serde(with = "crate::b::form")] struct A;',
        "#[derive(crate::b::B)] struct A;",
        "use crate::B;",
        "use crate::C;",
        "use super::front::Renamed;",
        "use crate::front::*; fn f() { Renamed }",
        "use crate::b::made_by_a_macro;",
        "#[cfg(not(test))] use crate::b::B;",
        '#[cfg(feature = "test")] use crate::b::B;',
        "#[cfg(test)] use std::fmt; use crate::b::B;",
        '#[cfg(test)] mod tests { fn f() { \'{\'; "{"; r#"{"{"# } } use crate::b::B;',
        "struct A { #[cfg(test)] pub x: u8, pub y: crate::b::B }",
        "fn f() { match x { #[cfg(test)] X => 1, Y => crate::b::B } }",
        "#[cfg(test)] const fn f() { } use crate::b::B;",
        "#[cfg(test)] const A: [u8; 2] = { [1, 2] }; use crate::b::B;",
        "fn f<'a>(x: &'a str) -> char { '\\'' } use crate::b::B;",
        "/* /* nested */ */ use crate::b::B;",
        'const A: &str = "\\"//"; use crate::b::B;',
        'const A: &str = r##""# //"##; use crate::b::B;',
        "use r#crate::x; use crate::r#b::B;",
    ],
)
def test_what_is_a_dependence(tmp_path, text):
    lib = "mod front { pub use crate::C as Renamed; }\npub use b::B;\npub use front::Renamed as D;\nuse b::B as C;"
    crate(tmp_path, a=text, b="use crate::a::A;\npub struct B;", lib=lib)
    assert of("a", "b") in circles(tmp_path)


@pytest.mark.parametrize(
    "text",
    [
        "// use crate::b::B;",
        "/// [`crate::b::B`]\nstruct A;",
        "/* /* */ use crate::b::B; */",
        'const A: &str = "crate::b::B";',
        'const A: &str = r#"" crate::b::B"#;',
        "fn f(x: X) { x.b; x.b::<B>() }",
        "fn f(b: X) { b }",
        "use other::b::B; use ::b::B;",
        "#[cfg(test)] use crate::b::B;",
        "#[cfg(test)] use crate::{b::{B}, std};",
        '#[cfg(any(test, feature = "fixture"))] use crate::b::B;',
        "#[cfg(all(test, not(windows)))] use crate::b::B;",
        "#[cfg(test)] pub(crate) mod x { use crate::b::B; }",
        "mod tests { use crate::b::B; }",
        "#[cfg(test)] mod check;",
        "#![cfg(test)] use crate::b::B;",
        "#[cfg(test)] #[inline] pub fn f<A, B>() -> [u8; 2] { crate::b::B }",
        "#[cfg(test)] impl<const N: usize> X<N, N> for Y { const A: X = crate::b::B; }",
        "#[cfg(test)] const A: X = { 1; crate::b::B };",
        "#[cfg(test)] struct A(crate::b::B, crate::b::B);",
        "struct A { #[cfg(test)] pub x: crate::b::B, y: u8 }",
        "fn f() { #[cfg(test)] let x = if y { 1 } else { crate::b::B }; }",
        "fn f() { match x { #[cfg(test)] X => crate::b::B, Y => 1 } }",
    ],
)
def test_what_is_none(tmp_path, text):
    crate(tmp_path, a=text, b="use crate::a::A;\npub struct B;")
    assert circles(tmp_path) == []


def test_a_file_and_its_children_are_no_circle(tmp_path):
    engine = "mod job;\nmod answer;\npub use job::Job;\npub struct Engine;\nfn run() { answer::give() }\n"
    crate(
        tmp_path,
        engine=engine,
        engine__job="use super::Engine;\npub struct Job;",
        engine__answer="use super::Job;\nfn give() {}",
    )
    assert circles(tmp_path) == []


def test_circles_in_a_folder_and_through_it(tmp_path):
    study = "mod range;\nmod list;\npub mod deep { pub mod end; }\nfn f() { range::f() }"
    crate(
        tmp_path,
        study=study,
        study__range="use super::list::number;",
        study__list="use super::range;\npub fn number() {}",
        study__deep__end="use crate::run::go;\npub fn end() {}",
        run="mod more;\npub fn go() {}",
        run__more="use crate::study::deep::end::end;",
    )
    assert circles(tmp_path) == [of("run", "study"), of("list", "range", folder="k/src/study")]


def test_files_named_mod_rs_and_programs(tmp_path):
    files = {
        "k/src/lib.rs": "mod a;",
        "k/src/a/mod.rs": "mod x;\nmod y;",
        "k/src/a/x.rs": "use super::y::Y;\npub struct X;",
        "k/src/a/y.rs": "use super::x::X;\npub struct Y;",
        "k/src/main.rs": "mod p;\nmod q;\nuse k::a;",
        "k/src/p.rs": "use crate::q;",
        "k/src/q.rs": "use crate::p;",
        "k/src/bin/more.rs": "use k::a;",
    }
    assert circles(workspace(tmp_path, files)) == [of("x", "y", folder="k/src/a"), of("p", "q")]


def test_a_file_that_is_not_there_is_told(tmp_path, capsys):
    workspace(tmp_path, {"k/src/lib.rs": "mod gone;"})
    assert check_structure.main([str(tmp_path)]) == 1
    assert capsys.readouterr().out.endswith("lib.rs: there is no file of `mod gone`\n")


def test_exceptions_hold_exactly_what_is_there(tmp_path):
    crate(tmp_path, a="use crate::b;", b="use crate::a;", c="", d="")
    assert circles(tmp_path, {"k/src": [{"a", "b"}]}) == []
    gone = "k/src: c, d are no circle any more: take them out of EXCEPTIONS"
    assert circles(tmp_path, {"k/src": [{"a", "b"}, {"c", "d"}]}) == [gone]
    gone = "k/src: a, b, c are no circle any more: take them out of EXCEPTIONS"
    assert circles(tmp_path, {"k/src": [{"a", "b", "c"}]}) == [of("a", "b"), gone]


@pytest.mark.parametrize(
    "text",
    [
        "use rusqlite::Row;",
        "fn f(_: rusqlite::Result<()>) {}",
        'const S: &str = "SELECT a, b \\\n  FROM t";',
        'fn f() { run("\n INSERT OR IGNORE INTO t VALUES (1)") }',
        'fn f() { run(r"UPDATE t SET a = 1"); }',
        'fn f() { run("DELETE FROM t WHERE 1") }',
        'fn f() { run("PRAGMA quick_check(1)") }',
    ],
)
def test_sql_stands_in_one_folder(tmp_path, text):
    lib = "pub mod store;\npub mod other;"
    files = {"results/src/lib.rs": lib, f"{SQL_FOLDER}/mod.rs": text, "results/src/other.rs": f"mod tests {{ {text} }}"}
    manifests = {"results": "[dependencies]\nrusqlite.workspace = true\n", "tests": "[dependencies]\nrusqlite = '1'\n"}
    workspace(tmp_path, {**files, "tests/src/lib.rs": text}, manifests)
    assert check(tmp_path, {}) == []
    (tmp_path / "results/src/other.rs").write_text(text)
    (wrong,) = check(tmp_path, {})
    assert wrong.startswith("results/src/other.rs:1: SQL is for results/src/store alone (")


def test_other_crates_depend_on_sql_in_tests_only(tmp_path):
    manifests = {
        "k": "[dev-dependencies]\nrusqlite.workspace = true\n",
        "m": "[dependencies]\nrusqlite.workspace = true\n",
    }
    workspace(tmp_path, {}, manifests)
    assert check(tmp_path, {}) == ["m/Cargo.toml: rusqlite is for results/src/store alone"]


def test_crates_that_must_not_be_named(tmp_path):
    manifests = {
        "solver": "[dependencies]\nserde = '1'\n[target.'cfg(unix)'.dependencies]\ntokio = '1'\n",
        "results": "[dependencies]\ntokio = '1'\nbus = { package = 'zenoh', version = '1' }\n",
    }
    files = {
        "solver/src/lib.rs": "mod local;\nfn f(zenoh: X) { zenoh; protocol::VERSION }\n",
        "solver/src/local.rs": "mod worker;\nuse worker::X;\n// zenoh::Session\n",
        "solver/src/local/worker.rs": "#[cfg(test)] use tokio::time;\npub struct X;\n",
        "results/src/lib.rs": "use tokio::time;\nuse zenoh::{Session, bytes::ZBytes};\n#[zenoh::main] fn f() {}\n",
        "coordinator/src/lib.rs": "use zenoh::Session;\nuse results::Report;\n",
    }
    assert check(workspace(tmp_path, files, manifests), {}) == [
        "results/Cargo.toml: results must not depend on zenoh",
        "results/src/lib.rs:2: results must not name zenoh (zenoh::Session)",
        "results/src/lib.rs:2: results must not name zenoh (zenoh::bytes::ZBytes)",
        "results/src/lib.rs:3: results must not name zenoh (zenoh::main)",
        "solver/Cargo.toml: solver must not depend on tokio",
        "solver/src/lib.rs:2: solver must not name protocol (protocol::VERSION)",
    ]


def test_the_exit_code(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(check_structure, "EXCEPTIONS", {})
    crate(tmp_path, a="use crate::b;", b="")
    assert check_structure.main([str(tmp_path)]) == 0
    assert capsys.readouterr().out == ""
    (tmp_path / "k/src/b.rs").write_text("use crate::a;")
    assert check_structure.main([str(tmp_path)]) == 1
    assert capsys.readouterr().out.startswith(of("a", "b"))


def test_a_patch_is_what_is_built(tmp_path):
    top = workspace(tmp_path, {"k/src/lib.rs": ""})
    with (top / "Cargo.toml").open("a") as manifest:
        manifest.write('[patch.crates-io]\nlink = { path = "third_party/link" }\n')
    lock = '[[package]]\nname = "link"\nversion = "1.0.0"\n'
    (top / "Cargo.lock").write_text(lock)
    assert check(top, {}) == []
    passed_over = lock + 'source = "registry+https://example.org"\n'
    for text in (passed_over, lock + passed_over, '[[package]]\nname = "k"\n'):
        (top / "Cargo.lock").write_text(text)
        (sentence,) = check(top, {})
        assert sentence.startswith("Cargo.toml: link is not built from third_party/link")


def test_rules_are_those_of_crates_that_there_are():
    top = Path(__file__).parents[2]
    names = {package.relative_to(top).as_posix() for package in check_structure.members(top)}
    assert check_structure.MUST_NOT_NAME.keys() | check_structure.TESTS <= names
