//! Commands about whole objects.

use super::CommandError;
use super::args::Args;
use super::session::{CommandReply, SketchSession};
use super::subject::ReplySubject;
use std::sync::Arc;

impl SketchSession {
    pub(super) fn using(&mut self, args: &mut Args, required: bool) -> Result<(), CommandError> {
        if args.len() == 0 && !required {
            return self.active().map(|_| ());
        }
        let name = args.name("the name of an object")?;
        args.end()?;
        self.known(&name)?;
        self.state.active = Some(name.to_lowercase());
        Ok(())
    }

    /// The name of an object to be made: free, and neither too short nor too long.
    fn free_name(&self, name: &str) -> Result<String, CommandError> {
        if name.is_empty() || name.chars().count() > 32 {
            return Err(CommandError::text(
                "an object's name has 1 to 32 characters",
                "choose another name",
            ));
        }
        if let Some(other) = self.object(name) {
            return Err(CommandError::text(
                format!("object {} exists already", other.name),
                "choose another name, or DELETE it",
            )
            .about(ReplySubject::of("name-not-free").names([&other.name])));
        }
        Ok(name.to_lowercase())
    }

    pub(super) fn rename(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let old = args.name("the old name")?;
        args.take_short("TO");
        let new = args.name("the new name")?;
        args.end()?;
        let mut object = self.known(&old)?.clone();
        let (from, to) = (old.to_lowercase(), new.to_lowercase());
        if from != to {
            self.free_name(&new)?;
            self.no_part(&old, &new)?;
        }
        let former = std::mem::replace(&mut object.name, new);
        let object = Arc::new(object);
        self.rename_followed(&former, &object);
        self.rename_read(&former, &object.name);
        // It keeps its index in the list.
        let place = self.state.objects.get_index_of(&from).unwrap_or(0);
        self.state.objects.shift_remove(&from);
        self.state.objects.shift_insert(place, to.clone(), object);
        if self.state.active.as_ref() == Some(&from) {
            self.state.active = Some(to);
        }
        Ok(())
    }

    pub(super) fn copy(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let old = args.name("the name of an object")?;
        args.take_short("TO");
        let new = args.name("the name of the copy")?;
        args.end()?;
        let mut object = self.known(&old)?.clone();
        self.free_name(&new)?;
        object.name = new;
        self.insert(object);
        Ok(())
    }

    /// `WITHIN name`: objects until LEAVE are the parts of that feature, for files.
    pub(super) fn within(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let name = args.name("the name of a feature")?;
        args.end()?;
        if self.state.outside.len() >= 32 {
            return Err(CommandError::text(
                "features are nested too deeply",
                "make fewer of each other",
            ));
        }
        let objects = std::mem::take(&mut self.state.objects);
        self.state.outside.push((objects, self.state.active.take(), name));
        Ok(())
    }

    /// `LEAVE`: the feature joins the objects outside.
    pub(super) fn leave(&mut self, args: &mut Args) -> Result<(), CommandError> {
        args.end()?;
        let Some((objects, _, name)) = self.state.outside.last().cloned() else {
            return Err(CommandError::text("no feature is open", "WITHIN name opens one"));
        };
        let object = self.known(&name)?.clone();
        self.state.outside.pop();
        self.state.objects = objects;
        self.no_circle(&object)?;
        self.insert(object);
        Ok(())
    }

    pub(super) fn dump(&mut self, args: &mut Args) -> Result<(), CommandError> {
        if let Some(token) = args.peek() {
            self.known(&token.text)?;
        }
        self.take_object(args)?;
        args.end()?;
        let object = self.active()?;
        let text = crate::format::json_format::to_json(object, &crate::script(object)).to_string();
        self.out.push(CommandReply::note(text));
        Ok(())
    }
}
