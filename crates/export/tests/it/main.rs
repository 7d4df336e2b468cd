//! The table of formats: every row writes as described.

mod spline_patches;

use moldloft_document::{Document, NoFiles, registry};
use moldloft_export::{
    FORMATS, Holds, Lids, SolidCells, SymmetryPlanes, WriteOptions, format_named, write,
    write_blocks, write_grids,
};
use moldloft_io::StructuredGrid;
use moldloft_num::Vec3;

/// Half a box in water with its lid, mirrored in y = 0; the end `fore` is in x = 0.
const BOX: &str = "
    Model info(symmetry = \"y\", units = \"m\");
    AbsPoint A(0, 1, 0); AbsPoint B(0, 1, -1); AbsPoint C(4, 1, 0); AbsPoint D(4, 1, -1);
    AbsPoint E(0, 0, -1); AbsPoint F(4, 0, -1); AbsPoint G(0, 0, 0); AbsPoint H(4, 0, 0);
    Line a(A, B); Line b(C, D); Line e(E, B); Line f(F, D); Line g(G, A); Line h(H, C);
    RuledSurf side(a, b, divisions = {2, 3}, tags = \"hull\");
    RuledSurf bottom(e, f, divisions = {2, 3}, orientation = 1);
    RuledSurf top(g, h, divisions = {2, 3}, tags = \"lid\");
    Line p(G, E); Line q(H, F); RuledSurf aft(b, q, divisions = {2, 2});
    RuledSurf fore(a, p, divisions = {2, 2});
";

const BRICK: &str = "
    AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(2, 1, 0);
    AbsPoint E(0, 0, 3); Line a(A, B); Line b(C, D); RuledSurf floor(a, b); Line up(A, E);
    TranSolid brick(floor, up, divisions = {4, 2, 3});
";

fn model(text: &str) -> Document {
    let model = Document::from_text(registry(), Box::new(NoFiles), "box.sdl", text);
    assert!(!model.has_errors(), "{:?}", model.diagnostics());
    model
}

#[test]
fn every_row_writes_what_it_says() {
    let options = WriteOptions::default();
    for format in FORMATS {
        let mut model = model(if format.holds == Holds::Volumes { BRICK } else { BOX });
        let main = format.file_name("box");
        let files = write(&mut model, format, &main, &options).unwrap_or_else(|e| panic!("{e:?}"));
        let name = format.name;
        assert!(!files.is_empty() && files.iter().all(|f| !f.bytes.is_empty()), "{name}");
        // Drawings are a sheet each, grids of several patches an index and a file each.
        let several = ["svg", "vts"].contains(&name);
        assert_eq!(files[0].name == main, !several, "{name}: {}", files[0].name);
        let text = files.iter().all(|f| std::str::from_utf8(&f.bytes).is_ok());
        assert_eq!(text && !files[0].bytes.contains(&0), format.text, "{name}");
        assert!(!format.about.is_empty() && !format.suffix.starts_with('.'), "{name}");
        // The same again gives the same bits.
        assert_eq!(write(&mut model, format, &main, &options).unwrap(), files, "{name}");
    }
}

#[test]
fn names_and_aliases_mean_one_format_each() {
    let mut seen = std::collections::BTreeSet::new();
    for format in FORMATS {
        for name in format.aliases.iter().chain([&format.name]) {
            assert!(seen.insert(*name), "{name} twice");
            assert_eq!(format_named(&name.to_uppercase()).unwrap().name, format.name);
        }
    }
    let error = format_named("dat").err().unwrap();
    assert!(error.expected.as_ref().unwrap().contains("`aqwa`"));
    let error = format_named("gfd").err().unwrap();
    assert!(error.message.contains("`gfd`") && error.expected.as_ref().unwrap().contains("gdf"));
}

#[test]
fn options_are_taken_or_refused() {
    let all = [
        WriteOptions { lids: true, ..WriteOptions::default() },
        WriteOptions { immersed: true, ..WriteOptions::default() },
        WriteOptions { tags: vec!["hull".into()], ..WriteOptions::default() },
        WriteOptions { tolerance: Some(0.1), ..WriteOptions::default() },
    ];
    for format in FORMATS {
        let whole = matches!(format.holds, Holds::Surfaces | Holds::Volumes);
        let takes = [
            format.lids != Lids::Patches,
            format.immersed,
            !whole,
            matches!(format.holds, Holds::Surfaces | Holds::Panels | Holds::PanelsAndLines),
        ];
        let mut model = model(if format.holds == Holds::Volumes { BRICK } else { BOX });
        for (options, takes) in all.iter().zip(takes) {
            let made = write(&mut model, format, &format.file_name("box"), options);
            assert_eq!(made.is_ok(), takes, "{} {options:?}", format.name);
        }
    }
}

#[test]
fn lids_go_where_the_row_says() {
    for format in FORMATS.iter().filter(|f| f.lids != Lids::Patches) {
        let mut model = model(BOX);
        let mut files = |lids| {
            let options = WriteOptions { lids, ..WriteOptions::default() };
            write(&mut model, format, &format.file_name("box"), &options).unwrap()
        };
        let (without, with) = (files(false), files(true));
        let own = format.lids == Lids::OwnFile;
        let found = (with.len(), with[0] == without[0]);
        assert_eq!(found, (1 + usize::from(own), own), "{}", format.name);
    }
}

#[test]
fn a_symmetry_without_a_flag_is_written_out() {
    let panels = |symmetry: &str, name: &str| {
        let mut text = BOX.replace("symmetry = \"y\"", &format!("symmetry = \"{symmetry}\""));
        if symmetry.contains('x') {
            text = text.replace("fore(a, p, ", "fore(a, p, visible = 0, ");
        }
        let options = WriteOptions::default();
        let format = format_named(name).unwrap();
        let file = write(&mut model(&text), format, "box", &options).unwrap().remove(0);
        String::from_utf8(file.bytes).unwrap()
    };
    let gdf = panels("xy", "gdf");
    assert_eq!(gdf.lines().nth(2), Some("1 1"));
    assert_eq!(gdf.lines().nth(3), Some("16"));
    // Nemoh has no flag for x = 0: twice the panels.
    assert!(panels("xy", "nemoh").lines().count() > panels("y", "nemoh").lines().count() * 3 / 2);
    assert_eq!(SymmetryPlanes::YThenX.names_x(true), !SymmetryPlanes::YThenX.names_x(false));
    // HAMS has one flag at a time: the image in x = 0 is written.
    let hams = panels("xy", "hams");
    let counts: Vec<&str> = hams.lines().nth(3).unwrap().split_whitespace().collect();
    assert_eq!((counts[0], &counts[2..]), ("32", &["0", "1"][..]));
}

/// A hull without its end or bottom displaces nothing: its files are errors, unless patches are chosen
/// or a part is allowed.
#[test]
fn panel_codes_take_no_open_skin() {
    let codes = FORMATS.iter().filter(|f| f.immersed || f.name == "gdf-high");
    for format in codes {
        let without = |word: &str| {
            let lines = BOX.lines().map(|line| match line.trim().contains(&format!("{word}(")) {
                true => line.replace("divisions", "visible = 0, divisions"),
                false => line.to_string(),
            });
            lines.collect::<Vec<_>>().join("\n")
        };
        for (text, tags, partial, written) in [
            (without("top"), vec![], false, true),
            (without("aft"), vec![], false, false),
            (without("bottom"), vec![], false, false),
            (without("aft"), vec!["hull".to_string()], false, format.immersed),
            (without("aft"), vec![], true, true),
        ] {
            let mut model = model(&text);
            model.allow_partial(partial);
            let options = WriteOptions { tags, ..WriteOptions::default() };
            let made = write(&mut model, format, &format.file_name("box"), &options);
            assert_eq!(made.is_ok(), written, "{} {made:?}", format.name);
            if let (Err(faults), []) = (made, &options.tags[..]) {
                assert_eq!(faults[0].id, "open-below-water");
            }
            assert_eq!(model.export_remarks().len(), usize::from(partial));
        }
    }
}

const BOWL: &str = "
    BCurve half({{0, 0, -2}, {2, 0, -2}, {2, 0, 2}, {0, 0, 2}}); Line axis({0, 0, -2}, {0, 0, 2});
    RevSurf ball(half, axis, 0, PI, visible = 0); AbsMagnet m(ball, 0.2, 0.2); AbsMagnet n(ball, 0.8, 0.3);
    AbsMagnet o(ball, 0.5, 0.9); LineSnake mn(m, n); LineSnake no(n, o); LineSnake om(o, m);
    TrimSurf cap(ball, {mn, no, om});
";

/// A tolerance beyond reach is an error or a remark with the distance, never a coarser file.
#[test]
fn a_tolerance_is_met_or_named() {
    let stl = format_named("stl").unwrap();
    let fine = |tolerance| WriteOptions { tolerance: Some(tolerance), ..WriteOptions::default() };
    let mut bowl = model(BOWL);
    assert!(write(&mut bowl, stl, "bowl.stl", &fine(1e-4)).is_ok());
    assert!(bowl.export_remarks().iter().all(|r| r.id != "coarse-panels"));
    let faults = write(&mut bowl, stl, "bowl.stl", &fine(1e-9)).unwrap_err();
    assert_eq!(faults[0].id, "too-many-panels");
    assert!(faults[0].found.as_ref().unwrap().contains("of `cap`"), "{faults:?}");
    // Panels across oblique knuckles in both directions never come near them.
    let mut roof = model(
        "BCurve a({{0, 0, 0}, {2, 0, 1}, {4, 0, 0}}, degree = 1); BCurve b({{0, 3, 0}, {2, 3, 1}, {4, 3, 0}}, degree = 1);
         BCurve c({{0, 1.5, 1}, {2, 1.5, 2}, {4, 1.5, 1}}, degree = 1);
         BLoftSurf roof({a, c, b}, degree = 1, visible = 0); AbsMagnet m(roof, 0.1, 0.1); AbsMagnet n(roof, 0.7, 0.2);
         AbsMagnet o(roof, 0.9, 0.9); AbsMagnet p(roof, 0.3, 0.8); LineSnake mn(m, n); LineSnake no(n, o);
         LineSnake po(p, o); LineSnake mp(m, p); SubSurf part({mn, no, po, mp}, divisions = {5, 5});",
    );
    assert!(write(&mut roof, stl, "roof.stl", &fine(1e-5)).is_ok());
    let remark = roof.export_remarks().iter().find(|r| r.id == "coarse-panels").unwrap();
    assert!(remark.message.contains("`part`") && remark.message.contains("1.00e-5"), "{remark:?}");
}

#[test]
fn grids_and_blocks_without_a_model() {
    let points: Vec<Vec3> = (0..6).map(|k| Vec3::of((k / 3) as f64, (k % 3) as f64, 0.0)).collect();
    let grid = StructuredGrid::surface(2, 3, &points);
    let mut brick = model(BRICK);
    let blocks = brick.blocked().unwrap();
    for format in FORMATS {
        let name = format.file_name("x");
        let made = write_grids(std::slice::from_ref(&grid), &["s".into()], format, &name);
        assert_eq!(made.is_ok(), format.grids.is_some(), "{}", format.name);
        let cells = SolidCells { blocks: &blocks.blocks, symmetry: "", length: "" };
        let made = write_blocks(&cells, format, &name);
        assert_eq!(made.is_ok(), format.volume.is_some(), "{}", format.name);
        if let Ok(files) = made {
            assert_eq!(files, write(&mut brick, format, &name, &WriteOptions::default()).unwrap());
        }
    }
}

/// The language writes grids of points in the formats that hold such, by functions of their names.
#[test]
fn the_language_has_a_function_for_each_format_of_grids() {
    for format in FORMATS.iter().filter(|f| f.grids.is_some()) {
        let text = format!(
            "surface s[2, 3] = {{0, 0, 1}}; s[1:2, 1:3] = {{0, 0, 1}}; \
             s[1,1] = {{0, 0, 0}}; s[2,1] = {{1, 0, 0}}; s[1,2] = {{0, 1, 0}}; s[2,2] = {{1, 1, 0}}; \
             s[1,3] = {{0, 2, 0}}; s[2,3] = {{1, 2, 0}}; write_{0}(\"a.{0}\", s);",
            format.name
        );
        let model = model(&text);
        let (name, bytes) = model.written().next().unwrap();
        let points = [0, 1, 2, 3, 4, 5].map(|k| Vec3::of((k / 3) as f64, (k % 3) as f64, 0.0));
        let grid = StructuredGrid::surface(2, 3, &points);
        let files = write_grids(&[grid], &["s".into()], format, name).unwrap();
        assert_eq!((files[0].name.as_str(), files[0].bytes.as_slice()), (name, bytes));
    }
}
