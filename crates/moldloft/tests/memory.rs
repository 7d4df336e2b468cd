//! The system refuses memory at every n-th allocation: the operation succeeds, or fails with an
//! error and an unchanged state; the process never ends. The refusing allocator is below
//! [`moldloft::budget::Counting`].
//!
//! Two kinds of refusal: the n-th allocation alone, and a heap that is full from the n-th on, until something is freed.
#![expect(unsafe_code, reason = "an allocator that hands everything to the system's, or refuses")]

use moldloft::budget::{Budget, Counting};
use moldloft::session::Session;
use moldloft::sketch::SketchSession;
use moldloft::{Document, NoFiles, TextFormat, Value, WriteOptions, format_named, registry, write};
use moldloft_testing::{rounds, soak};
use std::alloc::{GlobalAlloc, Layout, System};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};

/// The system's allocator, until it is set to refuse.
struct Refusing;

const NEVER: i64 = i64::MAX;

static HELD: AtomicI64 = AtomicI64::new(0);
/// Allocations since [`armed`].
static COUNT: AtomicI64 = AtomicI64::new(0);
/// The one at which refusal begins.
static AT: AtomicI64 = AtomicI64::new(NEVER);
/// The most bytes that may be held.
static CEILING: AtomicI64 = AtomicI64::new(NEVER);
/// True if all later allocations fail too.
static FULL: AtomicI64 = AtomicI64::new(0);
/// Allocations that were refused.
static REFUSALS: AtomicU64 = AtomicU64::new(0);

fn refuses(size: usize) -> bool {
    let here = COUNT.fetch_add(1, Ordering::Relaxed) == AT.load(Ordering::Relaxed);
    if here && FULL.load(Ordering::Relaxed) == 1 {
        CEILING.store(HELD.load(Ordering::Relaxed), Ordering::Relaxed);
    }
    let refused = (here && FULL.load(Ordering::Relaxed) == 0)
        || HELD.load(Ordering::Relaxed).saturating_add(size as i64)
            > CEILING.load(Ordering::Relaxed);
    REFUSALS.fetch_add(u64::from(refused), Ordering::Relaxed);
    refused
}

// SAFETY: every call is the system allocator's with the same arguments, or refuses, as the contract allows.
unsafe impl GlobalAlloc for Refusing {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if refuses(layout.size()) {
            return null_mut();
        }
        HELD.fetch_add(layout.size() as i64, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `GlobalAlloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size() as i64, Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(block, layout) };
    }
}

#[global_allocator]
static ALLOCATOR: Counting<Refusing> = Counting::over(Refusing);

/// Runs `work` while the allocation of that number fails and, with `full`, all later ones beyond
/// the memory then in use. Returns allocations, refusals, and the result; `None` after a panic.
fn armed<R>(at: i64, full: bool, work: impl FnOnce() -> R) -> (i64, u64, Option<R>) {
    FULL.store(i64::from(full), Ordering::Relaxed);
    REFUSALS.store(0, Ordering::Relaxed);
    COUNT.store(0, Ordering::Relaxed);
    AT.store(at, Ordering::Relaxed);
    let made = catch_unwind(AssertUnwindSafe(work));
    AT.store(NEVER, Ordering::Relaxed);
    CEILING.store(NEVER, Ordering::Relaxed);
    (COUNT.load(Ordering::Relaxed), REFUSALS.load(Ordering::Relaxed), made.ok())
}

/// Result of an operation as text, or the ids of its errors.
type Outcome = Result<String, Vec<String>>;

fn ids(faults: &[moldloft::Diagnostic]) -> Vec<String> {
    faults.iter().map(|fault| fault.id.to_string()).collect()
}

const HULL: &str = "param float beam = 5 in [3, 7]; farray rows = {0.2, 0.5, 0.9}; float sum = 0;
    for (i = 1:3) sum = sum + rows[i]; function float twice(float x) { return 2 * x; } float t = twice(sum);
    AbsPoint P11(0, 0, 0); AbsPoint P12(0.3, 0, -0.4); AbsPoint P13(0.9, 0, -0.8);
    AbsPoint P21(8, 0.5 * beam, 0); AbsPoint P22(8, 0.5 * beam, -1.4); AbsPoint P23(8, 0, -1.4);
    AbsPoint P31(16, 0.4 * beam, 0); AbsPoint P32(16, 0.4 * beam, -0.5); AbsPoint P33(16, 0, -0.5);
    BCurve MC1({P11, P12, P13}, degree = 2); BCurve MC2({P21, P22, P23}, degree = 2);
    BCurve MC3({P31, P32, P33}, degree = 2); Model info(symmetry = \"y\", units = \"m\");
    CLoftSurf hull({MC1, MC2, MC3}, divisions = {8, 4}); AbsMagnet m(hull, 0.4, 0.6);";

const FAIRED: &str = "AbsPoint A(0, 0.02, 0); AbsPoint B(1, 0.49, 0); AbsPoint C(2, 0.79, 0); AbsPoint D(3, 0.93, 0);
    AbsPoint E(4, 0.81, 0); AbsPoint F(5, 0.48, 0); AbsPoint G(6, 0.01, 0);
    FairCurve keel({A, B, C, D, E, F, G}, 0.02); ArcLenBead half(keel, 0.5);";

const BODY: &str = "set s = set(sphere({0, 0, 0}, 1)) & set(sphere({0.5, 0, 0}, 1));
    SetBody b(s, {-2, -2, -2}, {2, 2, 2}, depth = 3);";

fn model(text: &str) -> Document {
    Document::from_text(registry(), Box::new(NoFiles), "model.sdl", text)
}

/// All results of a model, as text with every digit.
fn reported(document: &mut Document) -> Outcome {
    if document.has_errors() {
        return Err(ids(&document.diagnostics()));
    }
    let panelled = document.panelled().map_err(|fault| ids(&[fault]))?;
    let mut found = format!("{:?}", panelled.mesh.positions());
    for format in ["stl", "svg"] {
        let row = format_named(format).map_err(|fault| ids(&[fault]))?;
        let files = write(document, row, "x", &WriteOptions::default()).map_err(|f| ids(&f))?;
        found.push_str(&format!("{:?}", files.iter().map(|f| &f.bytes).collect::<Vec<_>>()));
    }
    found.push_str(&document.text());
    Ok(found)
}

/// An operation on a model, by name.
type Operation = (&'static str, &'static str, fn(&mut Document) -> Outcome);

const OPERATIONS: &[Operation] = &[
    ("write", HULL, reported),
    ("set", HULL, |d| {
        let before = d.text();
        let made = d.set(&[("beam".into(), 4.5)]).map_err(|f| ids(&f)).and_then(|_| reported(d));
        // Back, as a person would.
        let back = d.set(&[("beam".into(), 5.0)]).map_err(|f| ids(&f));
        assert!(made.is_err() || back.is_err() || d.text() == before);
        back.and(made)
    }),
    ("text", HULL, |d| {
        d.set_text(&HULL.replace("-1.4", "-1.5"));
        let made = reported(d);
        d.set_text(HULL);
        made
    }),
    ("derivatives", HULL, |d| {
        let columns = d.jacobian(&["beam".into()]).map_err(|f| ids(&f))?;
        let slopes = d.derivatives(&["mesh.area".into(), "m.y".into()], &["beam".into()]);
        Ok(format!("{columns:?} {:?}", slopes.map_err(|f| ids(&f))?.len()))
    }),
    ("hydrostatics", HULL, |d| {
        // The hull has no transom.
        d.allow_partial(true);
        let found = d.hydrostatics(&d.hydrostatic_options()).map_err(|f| ids(&[f]))?;
        Ok(format!("{:?}", found.volume))
    }),
    ("convert", HULL, |d| d.convert(TextFormat::ModelFile).map_err(|f| ids(&f))),
    ("expressions", HULL, |d| {
        let mut found = String::new();
        for text in ["hull(0.5, 0.5).y + 2*sin(beam)^2", "MC2.length", "2 * rows"] {
            match d.eval(text).map_err(|f| ids(&f))? {
                Value::Number(x) => found.push_str(&format!("{x:?}")),
                Value::Numbers(all) => found.push_str(&format!("{:?}", all.items)),
                _ => return Err(vec!["neither number nor array".into()]),
            }
        }
        Ok(found)
    }),
    ("faired", FAIRED, reported),
    ("body", BODY, reported),
];

/// The operation; after a refusal, with the diagnostics of the model, such as the reason for a
/// missing mesh.
fn explained(operation: fn(&mut Document) -> Outcome, document: &mut Document) -> Outcome {
    operation(document).map_err(|mut found| {
        found.extend(ids(&document.diagnostics()));
        found
    })
}

/// True for ids of exhausted memory, and of their consequences.
fn is_refusal(found: &[String]) -> bool {
    let spent = |id: &String| id == "out-of-memory";
    found.iter().any(spent)
        && found.iter().all(|id| spent(id) || id == "blocked" || id == "no-mesh")
}

/// Numbers of the allocations to refuse, evenly spaced, at most `points`.
fn places(count: i64, points: usize) -> Vec<i64> {
    let step = (count as f64 / points as f64).max(1.0);
    (0..points).map(|k| (k as f64 * step) as i64).filter(|n| *n < count).collect()
}

#[derive(Default)]
struct Tally {
    points: usize,
    done: usize,
    refused: usize,
}

impl Tally {
    /// One point: the result is correct or a refusal by name.
    fn judge(&mut self, what: &str, outcome: Option<Outcome>, right: &str) {
        self.points += 1;
        match outcome {
            Some(Ok(found)) if found == right => self.done += 1,
            Some(Err(found)) if is_refusal(&found) => self.refused += 1,
            Some(Ok(_)) => panic!("{what}: another result"),
            Some(Err(found)) => panic!("{what}: {found:?}"),
            None => panic!("{what}: a panic"),
        }
    }
}

/// A request, so that the reserve is there again.
fn request() {
    let budget = Budget::default();
    drop(budget.timed());
}

fn of_documents(points: usize, tally: &mut Tally) {
    // A long run can be continued: by the name of one operation.
    let only = std::env::var("MOLDLOFT_MEMORY_ONLY").ok();
    let wanted = |name: &str| only.as_deref().is_none_or(|only| only == name);
    // The ordinary tests have no time for all.
    for (name, text, operation) in &OPERATIONS[..rounds(6, OPERATIONS.len())] {
        if !wanted(name) {
            continue;
        }
        let mut document = model(text);
        let right = operation(&mut document).unwrap_or_else(|ids| panic!("{name}: {ids:?}"));
        assert_eq!(operation(&mut document).as_ref(), Ok(&right), "{name}: twice");
        let (count, _, _) = armed(NEVER, false, || operation(&mut model(text)));
        println!("{name}: {count} allocations");
        for full in [false, true] {
            for at in places(count, points) {
                request();
                let budget = document.budget();
                let (_, _, outcome) = armed(at, full, || {
                    let _timed = budget.timed();
                    explained(*operation, &mut document)
                });
                tally.judge(&format!("{name} at {at}, full {full}"), outcome, &right);
                // The state is unchanged: the same model, and a new one, give the same results.
                request();
                document.set_text(text);
                assert_eq!(
                    operation(&mut document).as_ref(),
                    Ok(&right),
                    "{name} after {at}, full {full}"
                );
                // A model that is opened meanwhile.
                let (_, _, outcome) = armed(at, full, || {
                    let budget = Budget::default();
                    let _timed = budget.timed();
                    explained(*operation, &mut model(text))
                });
                tally.judge(&format!("{name} opened at {at}, full {full}"), outcome, &right);
            }
        }
    }
}

const REQUESTS: [&str; 5] = [
    r#"{"id": 1, "kind": "open"}"#,
    r#"{"id": 2, "kind": "set", "values": {"beam": 4}}"#,
    r#"{"id": 3, "kind": "complete", "offset": 12}"#,
    r#"{"id": 4, "kind": "hover", "offset": 14}"#,
    r#"{"id": 5, "kind": "set", "values": {"beam": 5}}"#,
];

fn of_sessions(points: usize, tally: &mut Tally) {
    let fresh = || Session::new(Box::new(NoFiles), "hull.sdl", HULL);
    let frames = |session: &mut Session| REQUESTS.map(|r| session.answer(r)).concat();
    let right = frames(&mut fresh());
    let (count, _, _) = armed(NEVER, false, || frames(&mut fresh()));
    println!("session: {count} allocations");
    for full in [false, true] {
        for at in places(count, points) {
            request();
            let (_, _, outcome) = armed(at, full, || {
                let budget = Budget::default();
                let _timed = budget.timed();
                let mut session = fresh();
                (frames(&mut session), session)
            });
            let (found, mut session) =
                outcome.unwrap_or_else(|| panic!("session at {at}: a panic"));
            let refused = String::from_utf8_lossy(&found).contains("out-of-memory");
            assert!(found == right || refused, "session at {at}, full {full}");
            tally.points += 1;
            tally.done += usize::from(!refused);
            tally.refused += usize::from(refused);
            // The text is there, and the next request is answered as ever.
            request();
            assert_eq!(session.text(), HULL);
            session.answer(r#"{"id": 6, "kind": "set", "values": {"beam": 5}}"#);
            session.document().run();
            assert_eq!(
                reported(session.document()),
                reported(&mut model(HULL)),
                "session after {at}"
            );
        }
    }
}

const SKETCH: &str = "SKETCH a\nSET UNITS M\nPOINT 1 AT 0 0\nPOINT 2 AT 400 0\nPOINT 3 AT 400 300\nPOINT 4 AT 0 300\n\
    LINE 1 FROM 1 TO 2 TYPE X\nLINE 2 FROM 2 TO 3 TYPE Y\nLINE 3 FROM 3 TO 4 TYPE X\nLINE 4 FROM 4 TO 1 TYPE Y\n";

fn of_sketches(points: usize, tally: &mut Tally) {
    let work = || {
        let mut session = SketchSession::new();
        let (mut found, mut faults) = (String::new(), Vec::new());
        for line in SKETCH.lines() {
            for reply in session.run_line(line) {
                match reply.is_error() {
                    true => faults.push(reply.text),
                    false => found.push_str(&reply.text),
                }
            }
        }
        if faults.is_empty() { Ok(found) } else { Err(faults) }
    };
    let right = work().expect("every line is right");
    let (count, _, _) = armed(NEVER, false, work);
    println!("sketch: {count} allocations");
    for full in [false, true] {
        for at in places(count, points) {
            request();
            let (_, _, outcome) = armed(at, full, || {
                let budget = Budget::default();
                let _timed = budget.timed();
                work()
            });
            tally.judge(&format!("sketch at {at}"), outcome, &right);
        }
    }
}

/// Long work after the refusal ends by name, within the reserve.
fn of_great_work(tally: &mut Tally) {
    let text = BODY.replace("depth = 3", "depth = 9");
    let (_, _, outcome) = armed(20_000, true, || {
        let budget = Budget::default();
        let _timed = budget.timed();
        let mut document = model(&text);
        document.panelled().map(|_| String::new()).map_err(|fault| ids(&[fault])).and_then(|_| {
            if document.has_errors() {
                Err(ids(&document.diagnostics()))
            } else {
                Ok(String::new())
            }
        })
    });
    tally.points += 1;
    match outcome {
        Some(Err(found)) if is_refusal(&found) => tally.refused += 1,
        other => panic!("a great body: {other:?}"),
    }
}

fn main() {
    // The reserve is there once the allocator has counted enough.
    drop(vec![0u8; 1 << 20]);
    request();
    // Threads of the pool are there before anything is refused.
    assert!(!model(HULL).has_errors(), "{:?}", model(HULL).diagnostics());
    reported(&mut model(HULL)).unwrap();
    reported(&mut model(BODY)).unwrap();
    // A part of the long run, for a slow machine.
    let asked = std::env::var("MOLDLOFT_MEMORY_POINTS").ok().and_then(|n| n.parse().ok());
    let points = asked.unwrap_or_else(|| rounds(6, 420));
    let mut tally = Tally::default();
    of_documents(points, &mut tally);
    if soak() {
        of_sketches(points, &mut tally);
        of_sessions(points, &mut tally);
        of_great_work(&mut tally);
    }
    println!("{} points: {} done, {} refused", tally.points, tally.done, tally.refused);
    assert!(tally.refused > 0 && tally.done > 0);
}
