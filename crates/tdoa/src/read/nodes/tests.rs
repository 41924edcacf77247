//! Tables of nodes in the plane and in space.

use proptest::prelude::*;

use super::*;

fn nodes(text: &str) -> Result<Nodes, String> {
    read_nodes_from(text.as_bytes(), "f.csv").map_err(|error| error.to_string())
}

fn names(nodes: &Nodes) -> Vec<Option<&str>> {
    nodes.nodes.iter().map(|node| node.name.as_deref()).collect()
}

/// Of every node, its deviations as text, in which NaN equals NaN.
fn sigmas(nodes: &Nodes) -> Vec<String> {
    nodes.nodes.iter().map(|node| format!("{:?}", node.sigma)).collect()
}

#[test]
fn first_lines_in_other_words_and_orders() {
    for text in [
        "name,x,y\na,1,2\nb,3,4\n",
        "y,x,Mic\n2,1,a\n4,3,b\n",
        "anchor;x (m);y (m)\na;1,0;2\nb;3;4,0\n",
        "what,x,y\na,1,2\nb,3,4\n",
        "a,1,2\nb,3,4\n",
        "id,x,y,z\na,1,2,\nb,3,4,\n",
        "\n# a comment\nid,x,y\n,,\na,1,2\nb,3,4\n",
    ] {
        let found = nodes(text).unwrap();
        assert_eq!(names(&found), [Some("a"), Some("b")], "{text}");
        assert_eq!(found.positions(), [Some([1.0, 2.0]), Some([3.0, 4.0])], "{text}");
        assert_eq!((found.dimensions(), found.is_named(), found.has_sigmas), (2, true, false), "{text}");
    }
    assert!(!nodes("1,2\n3,4\n").unwrap().is_named());
}

#[test]
fn deviations_and_single_coordinates_are_kept() {
    let found = nodes("id,x,y,sigma\na,1,2,0.5\nb,3,4,0\nc,,6,0.1\nd,7,8,\n").unwrap();
    assert_eq!(found.positions(), [Some([1.0, 2.0]), Some([3.0, 4.0]), None, Some([7.0, 8.0])]);
    assert!(found.has_sigmas);
    assert_eq!(sigmas(&found), ["[0.5, 0.5, NaN]", "[0.0, 0.0, NaN]", "[0.1, 0.1, NaN]", "[NaN, NaN, NaN]"]);
    assert_eq!(found.named("c").unwrap().position, [None, Some(6.0), None]);
    let found = nodes("kind,name,x,y,std_x,std_y\nreceiver,a,1,2,0.5,0.25\n").unwrap();
    assert_eq!(sigmas(&found), ["[0.5, 0.25, NaN]"]);
    assert!(nodes("id,x,y,std_x\na,1,2,3\n").unwrap_err().contains("give both std_x and std_y, or"));
    assert!(nodes("id,x,y,std_x,std_y,sigma\na,1,2,3,4,5\n").unwrap_err().contains("both standard deviations"));
    assert!(nodes("id,x,y\na,1,\na,1,2\n").unwrap_err().contains("is there twice"));
    assert!(nodes("id,x,y,std_mm\na,1,2,3\n").unwrap_err().contains("convert it to metres"));
}

#[test]
fn heights_are_kept() {
    let found = nodes("id,x,y,z\na,1,2,0.5\nb,3,4,\nc,5,6,-1\n").unwrap();
    assert_eq!(found.height_range(), Some([-1.0, 0.5]));
    assert_eq!(nodes("a,1,2,7\n").unwrap().height_range(), Some([7.0, 7.0]));
    assert_eq!(nodes("a,1,2\n").unwrap().height_range(), None);
}

#[test]
fn heights_that_differ_are_space() {
    for (text, dimensions, space) in [
        ("id,x,y,z\na,1,2,3\nb,4,5,6\n", 3, [Some([1.0, 2.0, 3.0]), Some([4.0, 5.0, 6.0])]),
        ("z;y;x;id\n3,0;2;1;a\n;5;4;b\n", 2, [Some([1.0, 2.0, 3.0]), None]),
        ("x,y,altitude (m)\n1,2,-3\n4,5,0\n", 3, [Some([1.0, 2.0, -3.0]), Some([4.0, 5.0, 0.0])]),
        ("a,1,2,0.5\nb,4,5,0.5\n", 2, [Some([1.0, 2.0, 0.5]), Some([4.0, 5.0, 0.5])]),
        ("id,x,y,z\na,1,2,0\nb,4,5,-0.0\n", 2, [Some([1.0, 2.0, 0.0]), Some([4.0, 5.0, 0.0])]),
        ("id,x,y,z\na,1,2,0\nb,4,5\n", 2, [Some([1.0, 2.0, 0.0]), None]),
        ("id,x,y,z\na,1,2,\nb,4,5,\n", 2, [None, None]),
        ("id,x,y\na,1,2\nb,4,5\n", 2, [None, None]),
    ] {
        let found = nodes(text).unwrap();
        assert_eq!((found.dimensions(), found.positions()), (dimensions, space.to_vec()), "{text}");
        assert_eq!(found.positions(), [Some([1.0, 2.0]), Some([4.0, 5.0])], "{text}");
    }
    let found = nodes("id,x,y,z\na,1,2,3\nb,,,6\nc,7,,\n").unwrap();
    assert_eq!(found.named("b").unwrap().position, [None, None, Some(6.0)]);
    assert_eq!(found.named("c").unwrap().position, [Some(7.0), None, None]);
    let names = ["c", "b", "a", "d"].map(str::to_string);
    assert_eq!(found.in_order(&names), Some(vec![None, None, Some([1.0, 2.0, 3.0]), None]));
    assert_eq!(found.unknown(&names[..2]), ["a"]);
}

#[test]
fn deviations_of_z() {
    for (text, expected) in [
        ("id,x,y,z,sigma\na,1,2,3,0.5\n", "[0.5, 0.5, 0.5]"),
        ("id,x,y,z,std_x,std_y,std_z\na,1,2,3,0.1,0.2,0.3\n", "[0.1, 0.2, 0.3]"),
        ("id,std_z,std_y,std_x,z,y,x\na,0.3,,0.1,3,2,1\n", "[0.1, NaN, 0.3]"),
        // Of z none is given.
        ("id,x,y,z,std_x,std_y\na,1,2,3,0.1,0.2\n", "[0.1, 0.2, NaN]"),
        ("id,x,y,z,std_x,std_y,std_z\na,1,2,3,0.1,0.2\n", "[0.1, 0.2, NaN]"),
        // A deviation of nothing.
        ("id,x,y,std_x,std_y,std_z\na,1,2,0.1,0.2,0.3\n", "[0.1, 0.2, NaN]"),
    ] {
        let found = nodes(text).unwrap();
        assert_eq!((sigmas(&found), found.has_sigmas), (vec![expected.to_string()], true), "{text}");
    }
    for (text, part) in [
        ("id,x,y,z,std_z\na,1,2,3,4\n", "give both std_x and std_y (and std_z)"),
        ("id,x,y,z,std_y,std_z\na,1,2,3,4,5\n", "give both std_x and std_y (and std_z)"),
        ("id,x,y,z,sigma,std_z\na,1,2,3,4,5\n", "both standard deviations"),
        ("id,x,y,z,std_x,std_y,std_z_mm\na,1,2,3,4,5,6\n", "\"std_z_mm\" is in mm; convert it to metres"),
        ("id,x,y,z,std_x,std_y,std_z\na,1,2,3,4,5,six\n", "\"six\" is not a coordinate"),
    ] {
        let error = nodes(text).unwrap_err();
        assert!(error.contains(part), "{part:?} is not in: {error}");
    }
}

#[test]
fn what_is_no_table_of_positions() {
    for (text, part) in [
        ("", "has no positions"),
        ("id,x,y\n", "name (or id, receiver"),
        ("1,2,3\n4,5,6\n", "may be id,x,y or x,y,z"),
        ("id,lat,lon\na,1,2\n", "in any order"),
        ("id,x_mm,y_mm\na,1,2\n", "convert it to metres"),
        ("id,x,y,z_mm\na,1,2,3\n", "\"z_mm\" is in mm; convert it to metres"),
        ("id,x,y,height (cm)\na,1,2,3\n", "convert it to metres"),
        ("id,x,y\na,1,2\na,1,2\n", "receiver a is there twice, on line 2 too"),
        ("id,x,y,z\na,1,2,3\na,,,4\n", "receiver a is there twice, on line 2 too"),
        ("id,x,y\na,1,nan\n", "line 2"),
        ("id,x,y,z\na,1,2,inf\n", "column 4"),
        ("id,x,y\na,1\n", "has no column 3"),
        ("id,x,y\na,\n", "has no column 3"),
        ("id,x,y,z\na,,,\n", "leave out the line of a node that is not known"),
        ("x,y,z\n,,1\n", "leave out the line of a node that is not known"),
        ("id,x,y\na,1,left\n", "\"left\" is not a coordinate"),
        ("id,x,y,z\na,1,2,up\n", "\"up\" is not a coordinate"),
    ] {
        let error = nodes(text).unwrap_err();
        assert!(error.contains(part), "{part:?} is not in: {error}");
    }
}

proptest! {
    #[test]
    fn what_is_written_is_read(
        rows in proptest::collection::vec(
            (any::<[Option<i32>; 3]>(), any::<[Option<u8>; 3]>()).prop_filter("known", |row| row.0 != [None; 3]),
            1..8,
        ),
        order in Just([0, 1, 2, 3, 4, 5]).prop_shuffle(),
    ) {
        let headings = ["x", "y", "z", "std_x", "std_y", "std_z"];
        let mut text = format!("id,{}\n", order.map(|k| headings[k]).join(","));
        for (i, (position, sigma)) in rows.iter().enumerate() {
            let cells = |k: usize| if k < 3 { position[k].map(f64::from) } else { sigma[k - 3].map(f64::from) };
            let cells = order.map(|k| cells(k).map_or_else(String::new, |x| (x / 8.0).to_string()));
            text += &format!("r{i},{}\n", cells.join(","));
        }
        let found = nodes(&text).unwrap();
        prop_assert_eq!(found.nodes.len(), rows.len());
        for (i, (position, sigma)) in rows.iter().enumerate() {
            let node = found.named(&format!("r{i}")).unwrap();
            prop_assert_eq!(node.position, position.map(|x| x.map(|x| f64::from(x) / 8.0)));
            for k in 0..3 {
                let expected = sigma[k].map(|x| f64::from(x) / 8.0);
                prop_assert_eq!(Some(node.sigma[k]).filter(|x| !x.is_nan()), expected);
            }
        }
        let mut heights: Vec<i32> = rows.iter().filter_map(|row| row.0[2]).collect();
        heights.dedup();
        prop_assert_eq!(found.dimensions(), if heights.len() > 1 { 3 } else { 2 });
    }
}
