//! A recogniser that works straight from the grammar's text: slow, plain, and independent of the parser.

use std::collections::{BTreeMap, BTreeSet, HashMap};

#[derive(Clone, Debug)]
enum Node {
    Literal(String),
    Class(String),
    Rule(String),
    Sequence(Vec<Node>),
    Choice(Vec<Node>),
    Optional(Box<Node>),
    Repeated(Box<Node>),
}

pub struct Grammar {
    rules: BTreeMap<String, Node>,
    reserved: BTreeSet<String>,
    operators: Vec<String>,
}

impl Grammar {
    pub fn read(text: &str) -> Grammar {
        let mut tokens = grammar_tokens(text).into_iter().peekable();
        let mut rules = BTreeMap::new();
        while let Some(name) = tokens.next() {
            assert_eq!(tokens.next().as_deref(), Some("="), "after {name}");
            let node = choice(&mut tokens);
            assert_eq!(tokens.next().as_deref(), Some(";"), "after the rule {name}");
            rules.insert(name, node);
        }
        let mut literals = BTreeSet::new();
        rules.values().for_each(|rule| collect(rule, &mut literals));
        let mut reserved = BTreeSet::new();
        collect(&rules["reserved"], &mut reserved);
        let is_word = |text: &String| text.starts_with(|c: char| c.is_ascii_alphabetic());
        let mut operators: Vec<String> =
            literals.into_iter().filter(|text| !is_word(text)).collect();
        operators.sort_by_key(|text| std::cmp::Reverse(text.len()));
        Grammar { rules, reserved, operators }
    }

    pub fn accepts(&self, program: &str) -> bool {
        let Some(tokens) = self.tokens(program) else { return false };
        let mut run = Run { grammar: self, tokens: &tokens, memo: HashMap::new() };
        run.rule("program", 0).contains(&tokens.len())
    }

    /// The tokens as class and text; `None` if there is an invalid one.
    fn tokens(&self, text: &str) -> Option<Vec<(&'static str, String)>> {
        let mut tokens: Vec<(&'static str, String)> = Vec::new();
        let mut at = 0;
        let mut last_end = 0;
        while let Some(c) = text[at..].chars().next() {
            let rest = &text[at..];
            let last = tokens.last().map_or(("", ""), |(class, text)| (*class, text.as_str()));
            let ends_operand =
                matches!(last.0, "IDENT" | "WORD") || matches!(last.1, "]" | ")" | "}");
            let until = |stop: fn(char) -> bool| rest.find(stop).unwrap_or(rest.len());
            if c.is_ascii_whitespace() {
                at += 1;
                continue;
            } else if c == '#' {
                at += until(|c| c == '\n');
                continue;
            }
            let operand_dot = c == '.' && (ends_operand || last.0 == "NUMBER");
            let starts_number = |text: &str| text.starts_with(|c: char| c.is_ascii_digit());
            let (class, length) = if c.is_ascii_alphabetic() || c == '_' {
                let length = until(|c| !(c.is_ascii_alphanumeric() || c == '_'));
                let free = !self.reserved.contains(&rest[..length]) || last.0 == "MEMBERDOT";
                (if free { "IDENT" } else { "WORD" }, length)
            } else if c == '"' {
                let mut escaped = false;
                let end = rest[1..].find(|c| {
                    let closes = c == '"' && !escaped;
                    escaped = c == '\\' && !escaped;
                    closes || c == '\n'
                })?;
                ("TEXT", end + 2)
            } else if starts_number(rest) || (c == '.' && starts_number(&rest[1..]) && !operand_dot)
            {
                ("NUMBER", number_length(rest))
            } else {
                let operator =
                    self.operators.iter().find(|operator| rest.starts_with(operator.as_str()))?;
                let glued = at == last_end && (ends_operand || last.1 == "|");
                let before_word =
                    rest[1..].starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
                let member = operator == "." && glued && before_word;
                (if member { "MEMBERDOT" } else { "" }, operator.len())
            };
            tokens.push((class, rest[..length].to_owned()));
            at += length;
            last_end = at;
        }
        Some(tokens)
    }
}

fn number_length(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let mut length = digits(0);
    if text[length..].starts_with('.') && !text[length..].starts_with("...") {
        length += 1;
        length += digits(length);
    }
    if text[length..].starts_with(['e', 'E']) {
        let sign = usize::from(text[length + 1..].starts_with(['+', '-']));
        let exponent = digits(length + 1 + sign);
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}

struct Run<'a> {
    grammar: &'a Grammar,
    tokens: &'a [(&'static str, String)],
    memo: HashMap<(String, usize), BTreeSet<usize>>,
}

impl Run<'_> {
    /// Possible ends of the rule that starts at the token `at`.
    fn rule(&mut self, name: &str, at: usize) -> BTreeSet<usize> {
        let key = (name.to_owned(), at);
        if let Some(ends) = self.memo.get(&key) {
            return ends.clone();
        }
        let node = self
            .grammar
            .rules
            .get(name)
            .unwrap_or_else(|| panic!("the rule {name} is missing"))
            .clone();
        let ends = self.node(&node, at);
        self.memo.insert(key, ends.clone());
        ends
    }

    fn node(&mut self, node: &Node, at: usize) -> BTreeSet<usize> {
        match node {
            Node::Rule(name) => self.rule(name, at),
            Node::Literal(text) => {
                let fits = self.tokens.get(at).is_some_and(|(class, token)| {
                    token == text && !matches!(*class, "TEXT" | "MEMBERDOT")
                });
                fits.then_some(at + 1).into_iter().collect()
            }
            Node::Class(class) => {
                let fits = self.tokens.get(at).is_some_and(|(found, _)| {
                    found == class || (class == "WORD" && *found == "IDENT")
                });
                fits.then_some(at + 1).into_iter().collect()
            }
            Node::Sequence(parts) => {
                let mut ends = BTreeSet::from([at]);
                for part in parts {
                    ends = ends.into_iter().flat_map(|end| self.node(part, end)).collect();
                }
                ends
            }
            Node::Choice(parts) => parts.iter().flat_map(|part| self.node(part, at)).collect(),
            Node::Optional(part) => {
                let mut ends = self.node(part, at);
                ends.insert(at);
                ends
            }
            Node::Repeated(part) => {
                let mut ends = BTreeSet::from([at]);
                let mut open = vec![at];
                while let Some(from) = open.pop() {
                    for end in self.node(part, from) {
                        if ends.insert(end) {
                            open.push(end);
                        }
                    }
                }
                ends
            }
        }
    }
}

fn collect(node: &Node, literals: &mut BTreeSet<String>) {
    match node {
        Node::Literal(text) => {
            literals.insert(text.clone());
        }
        Node::Sequence(parts) | Node::Choice(parts) => {
            parts.iter().for_each(|part| collect(part, literals))
        }
        Node::Optional(part) | Node::Repeated(part) => collect(part, literals),
        Node::Class(_) | Node::Rule(_) => {}
    }
}

fn grammar_tokens(text: &str) -> Vec<String> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(c) = rest.chars().next() {
        let length = if rest.starts_with("(*") {
            rest = rest[rest.find("*)").expect("a closed comment") + 2..].trim_start();
            continue;
        } else if c == '"' {
            rest[1..].find('"').expect("a closed literal") + 2
        } else if c.is_ascii_alphabetic() {
            rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len())
        } else {
            c.len_utf8()
        };
        tokens.push(rest[..length].to_owned());
        rest = rest[length..].trim_start();
    }
    tokens
}

type Tokens = std::iter::Peekable<std::vec::IntoIter<String>>;

fn choice(tokens: &mut Tokens) -> Node {
    let mut parts = vec![sequence(tokens)];
    while tokens.next_if(|token| token == "|").is_some() {
        parts.push(sequence(tokens));
    }
    if parts.len() == 1 { parts.remove(0) } else { Node::Choice(parts) }
}

fn sequence(tokens: &mut Tokens) -> Node {
    let mut parts = Vec::new();
    while let Some(token) =
        tokens.next_if(|token| !matches!(token.as_str(), "|" | ")" | "]" | "}" | ";"))
    {
        let inner = |tokens: &mut Tokens, close: &str| {
            let node = choice(tokens);
            assert_eq!(tokens.next().as_deref(), Some(close));
            node
        };
        parts.push(match token.as_str() {
            "(" => inner(tokens, ")"),
            "[" => Node::Optional(Box::new(inner(tokens, "]"))),
            "{" => Node::Repeated(Box::new(inner(tokens, "}"))),
            text if text.starts_with('"') => Node::Literal(text.trim_matches('"').to_owned()),
            text if text.chars().all(|c| c.is_ascii_uppercase()) => Node::Class(text.to_owned()),
            text => Node::Rule(text.to_owned()),
        });
    }
    Node::Sequence(parts)
}
