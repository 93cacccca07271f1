//! Reader of Matrix Market files (<https://math.nist.gov/MatrixMarket/formats.html>).
//!
//! `coordinate` and `array`, `real` and `integer`, `general` and `symmetric`; indices count from 1. A symmetric file
//! may hold either triangle. An entry given twice is refused rather than summed: it is nearly always both triangles of
//! a file that calls itself symmetric, and summing would double the stiffness silently.

use crate::linalg::Matrix;
use crate::structure::ModelError;
use std::collections::HashMap;
use std::path::Path;

/// Largest order: the matrices are dense, and a header must not be able to ask for all the memory.
const MAX_ORDER: usize = 10_000;

/// Parses the text of a Matrix Market file; `file` only serves messages.
pub(super) fn parse(file: &Path, text: &str) -> Result<Matrix, ModelError> {
    Reader { file, text }.matrix()
}

struct Reader<'a> {
    file: &'a Path,
    text: &'a str,
}

impl Reader<'_> {
    fn error<T>(&self, line: usize, problem: impl Into<String>) -> Result<T, ModelError> {
        Err(ModelError::MatrixMarket { file: self.file.to_path_buf(), line, problem: problem.into() })
    }

    fn number<T: std::str::FromStr>(&self, line: usize, word: &str, what: &str) -> Result<T, ModelError> {
        word.parse().or_else(|_| self.error(line, format!("`{word}` is not {what}")))
    }

    fn matrix(&self) -> Result<Matrix, ModelError> {
        let mut lines = self.text.lines().enumerate().map(|(i, line)| (i + 1, line));
        let banner = lines.next().map_or("", |(_, line)| line).to_ascii_lowercase();
        let words: Vec<&str> = banner.split_whitespace().collect();
        let (format, symmetric) = match words[..] {
            ["%%matrixmarket", "matrix", format @ ("coordinate" | "array"), "real" | "integer", "general"] => {
                (format, false)
            }
            ["%%matrixmarket", "matrix", format @ ("coordinate" | "array"), "real" | "integer", "symmetric"] => {
                (format, true)
            }
            _ => {
                return self.error(
                    1,
                    format!(
                        "`{}` is not a header that can be read; expected `%%MatrixMarket matrix` followed by \
                         `coordinate` or `array`, `real` or `integer`, `general` or `symmetric`",
                        banner.chars().take(80).collect::<String>()
                    ),
                );
            }
        };
        let mut lines = lines
            .filter(|(_, line)| !line.starts_with('%'))
            .map(|(number, line)| (number, line.split_whitespace().collect::<Vec<_>>()))
            .filter(|(_, words)| !words.is_empty());
        let end = self.text.lines().count().max(1);
        let Some((line, sizes)) = lines.next() else {
            return self.error(end, "the file ends before the line of sizes");
        };
        let size = |i: usize| self.number::<usize>(line, sizes[i], "a number of rows, columns or entries");
        let (rows, cols, entries) = match (format, sizes.len()) {
            ("coordinate", 3) => (size(0)?, size(1)?, size(2)?),
            ("array", 2) => (size(0)?, size(1)?, 0),
            ("coordinate", _) => return self.error(line, "expected three sizes: rows, columns, entries"),
            _ => return self.error(line, "expected two sizes: rows, columns"),
        };
        if rows == 0 || cols == 0 || rows > MAX_ORDER || cols > MAX_ORDER {
            return self.error(
                line,
                format!(
                    "{rows} × {cols} is out of range: 1 to {MAX_ORDER} rows and columns; reduce larger models first"
                ),
            );
        }
        if symmetric && rows != cols {
            return self.error(line, format!("a symmetric matrix is square, this one is {rows} × {cols}"));
        }
        let mut matrix = Matrix::zeros(rows, cols);
        if format == "coordinate" {
            self.coordinate(&mut matrix, symmetric, entries, end, lines)?;
        } else {
            self.array(&mut matrix, symmetric, end, lines)?;
        }
        Ok(matrix)
    }

    fn coordinate<'t>(
        &self,
        matrix: &mut Matrix,
        symmetric: bool,
        entries: usize,
        end: usize,
        lines: impl Iterator<Item = (usize, Vec<&'t str>)>,
    ) -> Result<(), ModelError> {
        let mut seen = HashMap::new();
        for (line, words) in lines {
            let [i, j, value] = words[..] else {
                return self.error(line, format!("expected `row column value`, found {} words", words.len()));
            };
            if seen.len() == entries {
                return self.error(line, format!("more entries than the {entries} that the line of sizes announces"));
            }
            let i: usize = self.number(line, i, "a row number")?;
            let j: usize = self.number(line, j, "a column number")?;
            let value = self.value(line, (i, j), value)?;
            if i == 0 || j == 0 || i > matrix.rows() || j > matrix.cols() {
                let (rows, cols) = (matrix.rows(), matrix.cols());
                return self.error(line, format!("entry ({i}, {j}) is outside of 1..{rows} × 1..{cols}"));
            }
            let key = if symmetric { (i.max(j), i.min(j)) } else { (i, j) };
            if let Some(first) = seen.insert(key, line) {
                let why = if symmetric { " (a symmetric file holds one triangle only)" } else { "" };
                return self.error(line, format!("entry ({i}, {j}) was given before, on line {first}{why}"));
            }
            matrix[(i - 1, j - 1)] = value;
            if symmetric {
                matrix[(j - 1, i - 1)] = value;
            }
        }
        if seen.len() < entries {
            return self.error(end, format!("the file ends after {} of {entries} entries", seen.len()));
        }
        Ok(())
    }

    fn array<'t>(
        &self,
        matrix: &mut Matrix,
        symmetric: bool,
        end: usize,
        mut lines: impl Iterator<Item = (usize, Vec<&'t str>)>,
    ) -> Result<(), ModelError> {
        for j in 0..matrix.cols() {
            let first = if symmetric { j } else { 0 };
            for i in first..matrix.rows() {
                let (row, col) = (i + 1, j + 1);
                let Some((line, words)) = lines.next() else {
                    return self.error(end, format!("the file ends before entry ({row}, {col})"));
                };
                let [word] = words[..] else {
                    return self.error(line, format!("expected one value, found {} words", words.len()));
                };
                matrix[(i, j)] = self.value(line, (row, col), word)?;
                if symmetric {
                    matrix[(j, i)] = matrix[(i, j)];
                }
            }
        }
        match lines.next() {
            Some((line, _)) => self.error(line, "more values than the line of sizes announces"),
            None => Ok(()),
        }
    }

    fn value(&self, line: usize, (row, col): (usize, usize), word: &str) -> Result<f64, ModelError> {
        let finite = word.parse().ok().filter(|value: &f64| value.is_finite());
        finite.map_or_else(
            || {
                self.error(
                    line,
                    format!("entry ({row}, {col}) is `{word}`; a finite number is needed, written like -1.5e3"),
                )
            },
            Ok,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Matrix, String> {
        parse(Path::new("a.mtx"), text).map_err(|error| error.to_string())
    }

    fn refused(text: &str, parts: &[&str]) {
        let message = read(text).unwrap_err();
        for part in parts.iter().chain(&["a.mtx, line"]) {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }

    const COORDINATE: &str = "%%MatrixMarket matrix coordinate real symmetric\n";

    #[test]
    fn every_format_gives_the_same_matrix() {
        let expected = Matrix::from_fn(2, 2, |i, j| [[2.0, -1.0], [-1.0, 3.0]][i][j]);
        for text in [
            "%%MatrixMarket matrix coordinate real symmetric\n% comment\n\n2 2 3\n1 1 2e0\n2 1 -1\n2 2 3.0\n",
            "%%MatrixMarket MATRIX Coordinate Real Symmetric\n2 2 3\r\n1 1 2\r\n1 2 -1\r\n2 2 3\r\n",
            "%%MatrixMarket matrix coordinate integer general\n2 2 4\n1 1 2\n2 1 -1\n1 2 -1\n% late comment\n2 2 3",
            "%%MatrixMarket matrix array real general\n2 2\n2\n-1\n-1\n3\n",
            "%%MatrixMarket matrix array integer symmetric\n2 2\n2\n-1\n3\n",
        ] {
            assert_eq!(read(text).unwrap(), expected);
        }
    }

    #[test]
    fn arrays_run_down_the_columns() {
        let matrix = read("%%MatrixMarket matrix array real general\n3 2\n1\n2\n3\n4\n5\n6\n").unwrap();
        assert_eq!(matrix.column(1), [4.0, 5.0, 6.0]);
    }

    #[test]
    fn malformed_files_are_refused_with_their_line() {
        refused("", &["line 1", "coordinate"]);
        refused("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 0\n", &["line 1", "complex", "real"]);
        refused(COORDINATE, &["line of sizes"]);
        refused(&format!("{COORDINATE}2 2\n"), &["line 2", "three sizes"]);
        refused(&format!("{COORDINATE}2 3 1\n1 1 1\n"), &["line 2", "2 × 3", "square"]);
        refused(&format!("{COORDINATE}2 x 1\n"), &["line 2", "`x`"]);
        refused(&format!("{COORDINATE}999999999 999999999 1\n"), &["line 2", "10000"]);
        refused(&format!("{COORDINATE}2 2 1\n0 1 5.0\n"), &["line 3", "(0, 1)", "1..2"]);
        refused(&format!("{COORDINATE}2 2 1\n3 1 5.0\n"), &["line 3", "(3, 1)"]);
        refused(&format!("{COORDINATE}2 2 2\n1 1 5.0\n"), &["1 of 2 entries"]);
        refused(&format!("{COORDINATE}2 2 1\n1 1 5.0\n2 2 5.0\n"), &["line 4", "more entries"]);
        refused(&format!("{COORDINATE}2 2 1\n1 1\n"), &["line 3", "2 words"]);
        refused(&format!("{COORDINATE}2 2 1\n1 1 1,5\n"), &["line 3", "(1, 1)", "`1,5`", "-1.5e3"]);
        refused(&format!("{COORDINATE}2 2 1\n2 1 nan\n"), &["line 3", "(2, 1)", "`nan`", "finite"]);
        refused("%%MatrixMarket matrix array real general\n1 2\n1\ninf\n", &["line 4", "(1, 2)", "`inf`", "finite"]);
        refused("%%MatrixMarket matrix array real general\n1 1\n", &["(1, 1)"]);
        refused("%%MatrixMarket matrix array real general\n1 1\n1\n2\n", &["line 4", "more values"]);
    }

    #[test]
    fn an_entry_given_twice_is_refused() {
        refused(&format!("{COORDINATE}2 2 3\n1 1 1\n2 1 4\n1 2 4\n"), &["line 5", "(1, 2)", "line 4", "triangle"]);
    }
}
