//! Names across several files: uses of a declaration in other files, and the edits of a rename.
//! A file and the files that it loads share one namespace. A file inserted by a `Component` has its
//! own: outside, its names are members of the component and labels of its arguments.
//! Invariant: uses texts only, so it works on programs that cannot run; opens no file.

use super::mentions::{Mentions, mentions};
use moldloft_diag::{FileId, Span};
use moldloft_lang::run::inserted::INSERTED_FILES;
use moldloft_syntax::sdl::{self, ExprKind, Program, TextId};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The names in the files of a workspace.
#[derive(Debug, Default)]
pub struct Workspace {
    files: BTreeMap<String, WorkspaceFile>,
}

/// The names of one file.
#[derive(Debug)]
struct WorkspaceFile {
    uses: Vec<Use>,
    /// Indices of the uses of each name.
    by_name: HashMap<Box<str>, Vec<u32>>,
    /// The files that it loads, each with the `load` statement.
    loads: Vec<WorkspacePlace>,
    /// The files that its components insert.
    inserts: Vec<String>,
}

/// A name in a file.
#[derive(Clone, Debug)]
struct Use {
    name: Box<str>,
    start: u32,
    end: u32,
    declares: bool,
    owner: Owner,
}

/// Scope of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Owner {
    /// All files of the program.
    Program,
    /// A routine of this file, by its index.
    Routine(u32),
    /// The label of an argument, of the routine with this name if there is one.
    Label(Box<str>),
    /// The file that a component inserts.
    Component(String),
}

/// A place in a file of a [`Workspace`]: the file's name, first byte and end.
pub type WorkspacePlace = (String, u32, u32);

impl Workspace {
    /// True when the workspace has the file.
    pub fn contains(&self, file: &str) -> bool {
        self.files.contains_key(file)
    }

    /// The files, in the order of their names.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// The files that a file loads or inserts.
    pub fn loads(&self, file: &str) -> impl Iterator<Item = &str> {
        let names = self.files.get(file);
        let loads = names
            .into_iter()
            .flat_map(|names| names.loads.iter().map(|(file, ..)| file).chain(&names.inserts));
        loads.map(String::as_str)
    }

    /// Replaces a file's text; `resolve` gives the name of a file that it loads or inserts.
    pub fn set(&mut self, file: &str, text: &str, resolve: impl Fn(&str) -> Option<String>) {
        let (program, _) = sdl::parse(text, FileId(0));
        self.set_program(file, &program, resolve);
    }

    /// As [`Self::set`], for a parsed program.
    pub fn set_program(
        &mut self,
        file: &str,
        program: &Program,
        resolve: impl Fn(&str) -> Option<String>,
    ) {
        let found = mentions(program);
        let mut uses: Vec<Use> = Vec::with_capacity(found.names.len());
        for mention in &found.names {
            let owner = match mention.local_to {
                Some(routine) => Owner::Routine(routine.0),
                None => Owner::Program,
            };
            uses.push(one(program.name(mention.symbol), mention.span, mention.declares, owner));
        }
        members_and_labels(program, &found, &resolve, &mut uses);
        let mut by_name: HashMap<Box<str>, Vec<u32>> = HashMap::new();
        for (k, used) in uses.iter().enumerate() {
            by_name.entry(used.name.clone()).or_default().push(k as u32);
        }
        let load = |&(path, span): &(TextId, Span)| {
            resolve(&program[path]).map(|file| (file, span.start, span.end))
        };
        let loads: Vec<WorkspacePlace> = found.loads.iter().filter_map(load).collect();
        let inserts: BTreeSet<String> = uses
            .iter()
            .filter_map(|u| match &u.owner {
                Owner::Component(file) => Some(file.clone()),
                _ => None,
            })
            .collect();
        let inserts = inserts.into_iter().collect();
        self.files.insert(file.to_string(), WorkspaceFile { uses, by_name, loads, inserts });
    }

    /// Forgets a file.
    pub fn remove(&mut self, file: &str) {
        self.files.remove(file);
    }

    /// All positions at which the name at an offset has the same meaning, by file and position;
    /// empty without a name there.
    pub fn references(&self, file: &str, offset: u32) -> Vec<WorkspacePlace> {
        let Some((file, used)) = self.used_at(file, offset) else { return Vec::new() };
        self.places(&file, &used).into_iter().map(|(file, u)| (file, u.start, u.end)).collect()
    }

    /// The declaration of the name at an offset; for a `load`, the beginning of the loaded file.
    pub fn definition(&self, file: &str, offset: u32) -> Option<WorkspacePlace> {
        let mut loads = self.files.get(file).into_iter().flat_map(|names| &names.loads);
        if let Some((loaded, ..)) = loads.find(|(_, start, end)| (*start..*end).contains(&offset)) {
            return Some((loaded.clone(), 0, 0));
        }
        let (file, used) = self.used_at(file, offset)?;
        let all = self.places(&file, &used);
        let first = all.iter().filter(|(_, u)| u.declares);
        // A declaration in the same file takes precedence.
        let first = first.min_by_key(|(name, u)| (*name != file, name.clone(), u.start));
        first.map(|(file, u)| (file.clone(), u.start, u.end))
    }

    /// The positions to change when the name at an offset becomes `new`; `reserved` is true for the
    /// names of kinds and functions.
    ///
    /// # Errors
    /// If there is no name to rename, it is declared elsewhere, or `new` is not a name or is taken.
    pub fn renamed(
        &self,
        file: &str,
        offset: u32,
        new: &str,
        reserved: impl Fn(&str) -> bool,
    ) -> Result<Vec<WorkspacePlace>, String> {
        let (home, used) = self.used_at(file, offset).ok_or("no name at this position")?;
        let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let head = new.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        let free = || sdl::parse(format!("float {new};"), FileId(0)).1.is_empty();
        if !head || !new.chars().all(word) || !free() {
            return Err(format!(
                "`{new}` is not a valid name: a letter, then letters, digits and _"
            ));
        }
        let all = self.places(&home, &used);
        if !all.iter().any(|(_, u)| u.declares) {
            let several = if self.files.len() > 1 { "these files" } else { "this file" };
            return Err(format!("`{}` is not declared in {several}", used.name));
        }
        // Files in scope that already use the new name.
        let seen: BTreeSet<&str> = all
            .iter()
            .filter(|(_, u)| matches!(u.owner, Owner::Program | Owner::Routine(_)))
            .map(|(file, _)| file.as_str())
            .collect();
        let meets = |u: &Use| match (&used.owner, &u.owner) {
            (Owner::Routine(a), Owner::Routine(b)) => a == b,
            (_, Owner::Program | Owner::Routine(_)) => true,
            _ => false,
        };
        let wide: BTreeSet<String> = match used.owner {
            Owner::Routine(_) => seen.iter().map(|file| file.to_string()).collect(),
            _ => seen.iter().flat_map(|file| self.program_of(file)).collect(),
        };
        if reserved(new) || wide.iter().any(|file| self.named(file, new).any(meets)) {
            return Err(format!("`{new}` is already in use"));
        }
        Ok(all.into_iter().map(|(file, u)| (file, u.start, u.end)).collect())
    }

    /// Program-wide declarations whose name contains `query`, ignoring case.
    pub fn symbols(&self, query: &str) -> Vec<(String, WorkspacePlace)> {
        let query = query.to_ascii_lowercase();
        let mut found = Vec::new();
        for (file, names) in &self.files {
            let mut seen = BTreeSet::new();
            for u in &names.uses {
                let fits = u.declares
                    && u.owner == Owner::Program
                    && u.name.to_ascii_lowercase().contains(&query);
                if fits && seen.insert(&u.name) {
                    found.push((u.name.to_string(), (file.clone(), u.start, u.end)));
                }
            }
        }
        found
    }

    /// The name at an offset, and the file that it belongs to.
    fn used_at(&self, file: &str, offset: u32) -> Option<(String, Use)> {
        let names = self.files.get(file)?;
        let touching = names.uses.iter().filter(|u| u.start <= offset && offset <= u.end);
        // Of two adjacent names, the second begins at the offset.
        let used = touching.max_by_key(|u| u.start)?;
        match &used.owner {
            Owner::Component(inserted) => {
                let first = self.named(inserted, &used.name).find(|u| u.owner == Owner::Program)?;
                Some((inserted.clone(), first.clone()))
            }
            Owner::Label(callee) => {
                let (home, formal) = self.formal(file, callee, &used.name)?;
                Some((home, formal))
            }
            _ => Some((file.to_string(), used.clone())),
        }
    }

    /// A formal argument of a routine of the program.
    fn formal(&self, file: &str, routine: &str, name: &str) -> Option<(String, Use)> {
        for home in self.program_of(file) {
            let inside = self.routine_numbers(&home, routine);
            let formal = self.named(&home, name).find(|u| {
                u.declares && matches!(u.owner, Owner::Routine(n) if inside.contains(&n))
            });
            if let Some(formal) = formal {
                return Some((home.clone(), formal.clone()));
            }
        }
        None
    }

    /// Indices of the routines with this name: they own the local names after the declaration.
    fn routine_numbers(&self, file: &str, routine: &str) -> BTreeSet<u32> {
        let Some(names) = self.files.get(file) else { return BTreeSet::new() };
        let declared =
            self.named(file, routine).filter(|u| u.declares && u.owner == Owner::Program);
        declared
            .filter_map(|at| {
                let later = names.uses.iter().filter(|u| u.start > at.start);
                let next = later.min_by_key(|u| u.start)?;
                match next.owner {
                    Owner::Routine(n) => Some(n),
                    _ => None,
                }
            })
            .collect()
    }

    fn named<'a>(&'a self, file: &str, name: &str) -> impl Iterator<Item = &'a Use> + use<'a> {
        let names = self.files.get(file);
        let all = names.and_then(|names| Some((names, names.by_name.get(name)?)));
        all.into_iter().flat_map(|(names, all)| all.iter().map(|&k| &names.uses[k as usize]))
    }

    /// The files in the namespace of `file`: those that load it, and all that these load.
    fn program_of(&self, file: &str) -> BTreeSet<String> {
        let mut roots = BTreeSet::from([file.to_string()]);
        loop {
            let above = self.files.iter().filter(|(name, names)| {
                !roots.contains(*name) && names.loads.iter().any(|(l, ..)| roots.contains(l))
            });
            let above: Vec<String> = above.map(|(name, _)| name.clone()).collect();
            if above.is_empty() {
                break;
            }
            roots.extend(above);
        }
        let mut open: Vec<String> = roots.iter().cloned().collect();
        let mut all = roots;
        while let Some(name) = open.pop() {
            for (load, ..) in self.files.get(&name).into_iter().flat_map(|names| &names.loads) {
                if all.insert(load.clone()) {
                    open.push(load.clone());
                }
            }
        }
        all
    }

    /// All uses with the meaning of `used` in `file`, by file and position.
    fn places(&self, file: &str, used: &Use) -> Vec<(String, Use)> {
        let mut found: Vec<(String, Use)> = Vec::new();
        let mut homes = BTreeSet::new();
        match &used.owner {
            Owner::Routine(n) => {
                let own = self.named(file, &used.name).filter(|u| u.owner == Owner::Routine(*n));
                found.extend(own.map(|u| (file.to_string(), u.clone())));
                // Labels of calls name the formal arguments.
                for other in self.program_of(file) {
                    for u in self.named(&other, &used.name) {
                        if let Owner::Label(callee) = &u.owner
                            && self.routine_numbers(file, callee).contains(n)
                        {
                            found.push((other.clone(), u.clone()));
                        }
                    }
                }
            }
            _ => {
                let near = self.program_of(file);
                let declares = |file: &&String| {
                    self.named(file, &used.name).any(|u| u.declares && u.owner == Owner::Program)
                };
                homes.extend(near.iter().filter(declares).flat_map(|file| self.program_of(file)));
                if homes.is_empty() {
                    homes.insert(file.to_string());
                }
                for home in &homes {
                    let own = self.named(home, &used.name).filter(|u| u.owner == Owner::Program);
                    found.extend(own.map(|u| (home.clone(), u.clone())));
                }
                for other in self.files.keys() {
                    let outside = self
                        .named(other, &used.name)
                        .filter(|u| matches!(&u.owner, Owner::Component(of) if homes.contains(of)));
                    found.extend(outside.map(|u| (other.clone(), u.clone())));
                }
            }
        }
        found.sort_by(|a, b| (&a.0, a.1.start).cmp(&(&b.0, b.1.start)));
        found.dedup_by(|a, b| a.0 == b.0 && a.1.start == b.1.start);
        found
    }
}

fn one(name: &str, span: Span, declares: bool, owner: Owner) -> Use {
    Use { name: name.into(), start: span.start, end: span.end, declares, owner }
}

/// Names after dots and before `=` in arguments that belong to this program or to an inserted file.
fn members_and_labels(
    program: &Program,
    found: &Mentions,
    resolve: &impl Fn(&str) -> Option<String>,
    uses: &mut Vec<Use>,
) {
    let mut components = HashMap::new();
    for call in &found.calls {
        let callee = program.name(call.callee);
        let inserts = call.object.filter(|_| INSERTED_FILES.iter().any(|row| row.name == callee));
        let file = inserts.and_then(|_| {
            let first = program[call.args].first()?;
            match program[program.bare(first.value)].kind {
                ExprKind::Text(text) => resolve(&program[text]),
                _ => None,
            }
        });
        if let (Some(object), Some(file)) = (call.object, &file) {
            components.insert(object, file.clone());
        }
        for label in program[call.args].iter().filter_map(|arg| arg.name) {
            let owner = match &file {
                Some(file) => Owner::Component(file.clone()),
                None => Owner::Label(callee.into()),
            };
            uses.push(one(program.name(label.symbol), label.span, false, owner));
        }
    }
    for member in &found.members {
        if let Some(file) = member.base.and_then(|base| components.get(&base)) {
            let owner = Owner::Component(file.clone());
            uses.push(one(program.name(member.name), member.span, false, owner));
        }
    }
}
