//! Data kept between calls: a store that belongs to the model and is passed to every call.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// One value of each type, made on first use. Copies share their content, so a model shares it with
/// its runs with derivatives.
///
/// The store must not change any result: it only saves work.
#[derive(Clone, Default)]
pub struct Kept(Arc<Mutex<HashMap<TypeId, Arc<dyn Any + Send + Sync>>>>);

impl Kept {
    /// The value of that type.
    ///
    /// # Example
    /// ```
    /// use moldloft_registry::Kept;
    /// use std::sync::Mutex;
    ///
    /// let kept = Kept::default();
    /// kept.of::<Mutex<u32>>().lock().unwrap().clone_from(&7);
    /// assert_eq!(*kept.clone().of::<Mutex<u32>>().lock().unwrap(), 7);
    /// ```
    pub fn of<V: Any + Default + Send + Sync>(&self) -> Arc<V> {
        let mut values = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let value = values.entry(TypeId::of::<V>()).or_insert_with(|| Arc::new(V::default()));
        value.clone().downcast().unwrap_or_else(|_| Arc::new(V::default()))
    }
}

impl fmt::Debug for Kept {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let values = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        write!(f, "Kept({} types)", values.len())
    }
}
