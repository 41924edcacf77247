//! Further candidates of measurements, in columns and in lines.

use proptest::prelude::*;

use super::{ReadError, ReadOptions, Role, Units, message, parse, read_csv};
use crate::pseudoranges::Pseudoranges;

fn with(text: &str, options: ReadOptions) -> Result<Pseudoranges, ReadError> {
    read_csv(text.as_bytes(), "f.csv", options)
}

fn repeated() -> ReadOptions {
    ReadOptions { candidates: true, ..ReadOptions::default() }
}

#[test]
fn columns_with_a_number_are_candidates() {
    let f = parse("value3,mic,event,value2,value\n3,a,e,2,1\n,b,e,5,4\n,a,d,,6\n").unwrap();
    assert_eq!((f.candidates(0, 0), f.candidates(1, 0)), (&[1.0, 2.0, 3.0][..], &[4.0, 5.0][..]));
    assert_eq!((f.candidates(0, 1), f.candidates(1, 1)), (&[6.0][..], &[][..]));
    assert_eq!((f.get(0, 0), f.observed(), f.has_candidates()), (Some(1.0), 3, true));
    // Without a first one, the next is the first.
    let f = parse("mic,event,value,value2,value3\na,e,,2,3\na,d,,,\nb,e,nan,,7\n").unwrap();
    assert_eq!((f.candidates(0, 0), f.candidates(1, 0), f.observed()), (&[2.0, 3.0][..], &[7.0][..], 2));
    let f = parse("mic,event,range_1,range_2\na,e,1,2\n").unwrap();
    assert_eq!(f.candidates(0, 0), [1.0, 2.0]);
    let times = ReadOptions { units: Some(Units::Milliseconds { speed: 340.0 }), ..ReadOptions::default() };
    let f = with("mic;event;toa1 (ms);toa2 (ms);sigma\na;e;1,5;2,5;0,1\n", times).unwrap();
    assert_eq!((f.candidates(0, 0).len(), f.sigma(0, 0)), (2, Some(0.034)));
    assert!((f.candidates(0, 0)[1] - 0.85).abs() < 1e-12);
}

#[test]
fn options_say_which_columns_are_candidates() {
    let text = "mic,event,value,second,value2\na,e,1,2,3\n";
    let columns = |all: &[(Role, &str)]| ReadOptions {
        columns: all.iter().map(|(role, name)| (*role, name.to_string())).collect(),
        ..ReadOptions::default()
    };
    let candidates = |all: &[(Role, &str)]| with(text, columns(all)).unwrap().candidates(0, 0).to_vec();
    assert_eq!(candidates(&[]), [1.0, 3.0]);
    assert_eq!(candidates(&[(Role::Candidate, "second")]), [1.0, 2.0]);
    assert_eq!(candidates(&[(Role::Candidate, "value2"), (Role::Candidate, "second")]), [1.0, 3.0, 2.0]);
    assert_eq!(candidates(&[(Role::Ignore, "value2")]), [1.0]);
    assert_eq!(candidates(&[(Role::Value, "second")]), [2.0]);
}

#[test]
fn lines_of_one_pair_are_candidates_where_it_is_said() {
    let text = "mic,event,value\na,e,1\nb,e,5\na,e,2\na,e,\n";
    let said = message(text);
    assert!(said.contains("line 4") && said.contains("there twice, on line 2 too") && said.contains("--candidates"));
    let f = with(text, repeated()).unwrap();
    assert_eq!((f.candidates(0, 0), f.candidates(1, 0)), (&[1.0, 2.0][..], &[5.0][..]));
    // Line by line, and in each from left to right.
    let f = with("mic,event,value,value2\na,e,1,2\na,e,3,4\n", repeated()).unwrap();
    assert_eq!(f.candidates(0, 0), [1.0, 2.0, 3.0, 4.0]);
    let one = with("mic,event,value,sigma\na,e,1,0.5\na,e,2,0.5\n", repeated()).unwrap();
    assert_eq!(one.sigma(0, 0), Some(0.5));
}

#[test]
fn candidates_that_cannot_be_taken_are_refused() {
    for (text, options, parts) in [
        ("mic,event,value,sigma\na,e,1,0.5\na,e,2,0.6\n", repeated(), ["line 3", "one for all candidates"]),
        ("mic,event,value,value2,sigma2\na,e,1,2,0.6\n", ReadOptions::default(), ["sigma2", "ignore=sigma2"]),
        ("mic,event,value,value2 (ms)\na,e,1,2\n", ReadOptions::default(), ["value2 (ms)", "--units ms"]),
        ("mic,event,value,value2\na,e,1,x\n", ReadOptions::default(), ["line 2, column 4", "not a number"]),
        ("mic,event,value,value2\na,e,1,inf\n", ReadOptions::default(), ["receiver a, transmitter e", "not a usable"]),
        ("mic,reference,event,value,value2\na,b,e,1,2\n", ReadOptions::default(), ["differences", "ignore"]),
        ("mic,reference,event,value\na,b,e,1\n", repeated(), ["differences", "--candidates"]),
        ("1,2\n3,4\n", repeated(), ["line 1", "--candidates is for a list"]),
    ] {
        let said = with(text, options).unwrap_err().to_string();
        assert!(parts.iter().all(|part| said.contains(part)), "{text}: {said}");
    }
    let said = super::read_npy(&b""[..], "f.npy", repeated()).unwrap_err().to_string();
    assert!(said.contains("--candidates is for tables of text"), "{said}");
}

/// Candidates of each cell of a matrix; none where it is missing.
fn cells() -> impl Strategy<Value = Vec<Vec<Vec<f64>>>> {
    let cell = prop::collection::vec(-1e6..1e6f64, 0..4);
    (1usize..4).prop_flat_map(move |n| prop::collection::vec(prop::collection::vec(cell.clone(), n), 1..4))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn candidates_come_back_from_columns_and_from_lines(cells in cells()) {
        let mut columns = "receiver,transmitter,value,value2,value3\n".to_string();
        let mut lines = "receiver,transmitter,value\n".to_string();
        for (i, row) in cells.iter().enumerate() {
            for (j, all) in row.iter().enumerate() {
                let text = |k: usize| all.get(k).map_or_else(String::new, f64::to_string);
                columns += &format!("r{i},s{j},{},{},{}\n", text(0), text(1), text(2));
                // An empty line for each keeps the order of the names.
                lines += &format!("r{i},s{j},\n");
                all.iter().for_each(|value| lines += &format!("r{i},s{j},{value}\n"));
            }
        }
        for read in [with(&columns, ReadOptions::default()), with(&lines, repeated())] {
            let read = read.unwrap();
            for (i, row) in cells.iter().enumerate() {
                for (j, all) in row.iter().enumerate() {
                    prop_assert_eq!(read.candidates(i, j), &all[..]);
                    prop_assert_eq!(read.get(i, j), all.first().copied());
                }
            }
        }
    }
}
