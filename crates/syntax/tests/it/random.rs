//! Random texts with a fixed seed.
use moldloft_testing::Random;
use std::fmt::Write;

/// Number of rounds: two per cent of a long run, or all of it with `MOLDLOFT_SOAK=1`.
pub fn rounds(long: usize) -> usize {
    moldloft_testing::rounds(long / 50, long)
}

/// A generator of texts.
pub struct RandomText(Random);

impl RandomText {
    pub fn new(seed: u64) -> Self {
        RandomText(Random::new(seed))
    }

    pub fn below(&mut self, limit: usize) -> usize {
        self.0.below(limit)
    }

    pub fn pick<'a>(&mut self, from: &[&'a str]) -> &'a str {
        from[self.below(from.len())]
    }

    pub fn number_value(&mut self) -> f64 {
        let scale = [1.0, 0.001, 1e6, 1e20, 1e-9][self.below(5)];
        let whole = self.below(2000) as f64 - 1000.0;
        if self.below(2) == 0 { whole } else { whole * 0.1 * scale }
    }

    /// Some blanks, a line break or a comment: anything allowed between tokens.
    fn gap(&mut self, out: &mut String) {
        let gap = match self.below(40) {
            0..22 => " ",
            22..30 => "",
            30 => "\t",
            31 => "\n",
            32 => "\n\n  ",
            33 => " # why\n",
            34 => "\n# own line\n\n",
            _ => "  ",
        };
        // Words and numbers must not run together.
        let gap = if gap.is_empty()
            && out.ends_with(|c: char| c.is_ascii_alphanumeric() || ".|_".contains(c))
        {
            " "
        } else {
            gap
        };
        out.push_str(gap);
    }

    fn put(&mut self, out: &mut String, token: &str) {
        out.push_str(token);
        self.gap(out);
    }

    fn name(&mut self) -> &'static str {
        self.pick(&[
            "a", "b", "hull", "P21", "x", "field", "set", "in", "param", "assert", "_q", "PI_d2",
        ])
    }

    fn number(&mut self) -> String {
        let text = self.pick(&["0", "1", "2.", ".5", "3.25", "1e3", "1.E-3", "007", "12.5e+2"]);
        text.to_owned()
    }

    pub fn expr(&mut self, depth: u32, out: &mut String) {
        if depth == 0 {
            match self.below(8) {
                0..4 => {
                    let name = self.name();
                    self.put(out, name);
                }
                4 => self.put(out, "\"te\\\"xt # no\""),
                _ => {
                    let number = self.number();
                    self.put(out, &number);
                }
            }
            return;
        }
        let down = depth - 1;
        match self.below(16) {
            0..5 => {
                self.expr(down, out);
                let op = self.pick(&["+", "-", "*", "/", "^", "&", " | ", " . ", " .* "]);
                self.put(out, op);
                self.expr(down, out);
            }
            5 => {
                let op = self.pick(&["-", "+", "!", "not "]);
                self.put(out, "(");
                out.push_str(op);
                self.expr(down, out);
                self.put(out, ")");
            }
            6 => {
                let sign = self.pick(&["-", "- ", "+"]);
                out.push_str(sign);
                self.expr(0, out);
            }
            7 => {
                self.put(out, "(|(");
                self.expr(down, out);
                self.put(out, ")|)");
            }
            8 => {
                self.put(out, "{");
                for i in 0..self.below(4) {
                    if i > 0 {
                        self.put(out, ",");
                    }
                    self.expr(down, out);
                }
                self.put(out, "}");
            }
            9 | 10 => {
                out.push_str(self.pick(&["f", "S[3]", "fore.leg", "g(1)"]));
                self.arguments(down, out);
            }
            11 => {
                out.push_str(self.name());
                self.put(out, "[");
                let subs =
                    self.pick(&[":", " :45", "45: ", ",1", "1, ", "2:n-1:2", "i", "1,2,3", "a+b"]);
                self.put(out, subs);
                out.push(']');
                out.push_str(self.pick(&["", ".x", ".name", ".d1.x", " "]));
                self.gap(out);
            }
            12 => {
                self.put(out, "(");
                self.expr(down, out);
                let op = self.pick(&["<", ">=", "==", "!=", " or ", " and ", " || ", " && "]);
                self.put(out, op);
                self.expr(down, out);
                self.put(out, ")");
            }
            _ => {
                self.put(out, "(");
                self.expr(down, out);
                self.put(out, ")");
            }
        }
    }

    fn arguments(&mut self, depth: u32, out: &mut String) {
        self.put(out, "(");
        let count = self.below(4);
        for i in 0..count {
            if i > 0 {
                self.put(out, ",");
            }
            if i + 1 == count && self.below(2) == 0 {
                let name = self.pick(&["degree", "curve", "in", "surface"]);
                self.put(out, name);
                self.put(out, "=");
            }
            self.expr(depth, out);
        }
        self.put(out, ")");
    }

    pub fn stmt(&mut self, depth: u32, in_loop: bool, out: &mut String) {
        let down = depth.saturating_sub(1);
        match self.below(if depth == 0 { 8 } else { 15 }) {
            0 => {
                let _ = write!(out, "AbsPoint P{}", self.below(100));
                self.arguments(2, out);
                self.put(out, ";");
            }
            1 => {
                out.push_str(self.pick(&["a", "c[2:]", "s[1,].y", "hull"]));
                self.gap(out);
                let op = self.pick(&["=", "+=", "-=", "*=", "/=", "^="]);
                self.put(out, op);
                self.expr(3, out);
                self.put(out, ";");
            }
            2 => {
                let ty = self.pick(&[
                    "float",
                    "global int",
                    "curve",
                    "field",
                    "set",
                    "plane",
                    "surface",
                ]);
                out.push_str(ty);
                out.push_str(" v1");
                self.gap(out);
                if self.below(2) == 0 {
                    self.put(out, "[60, n],");
                    self.put(out, "v2");
                }
                self.put(out, "=");
                self.expr(3, out);
                self.put(out, ";");
            }
            3 => {
                self.put(out, "print ");
                self.expr(2, out);
                self.put(out, ";");
            }
            4 => {
                self.put(out, "assert ");
                self.put(out, "(a<b)");
                self.put(out, ", \"message\";");
            }
            5 => {
                out.push_str("set_barrel");
                self.arguments(2, out);
                self.put(out, ";");
            }
            6 => {
                let jump = if in_loop { self.pick(&["break;", "continue;", ";"]) } else { ";" };
                self.put(out, jump);
            }
            7 => {
                out.push_str("param ");
                out.push_str(self.pick(&["float ", "int ", ""]));
                self.put(out, "beam");
                self.put(out, "=");
                self.expr(1, out);
                let range = self.pick(&[";", " in [3 , 7];", " in[-1,a];"]);
                self.put(out, range);
            }
            8 | 9 => {
                self.put(out, "if");
                self.put(out, "(");
                self.expr(2, out);
                let then = self.pick(&[")", ") then "]);
                self.put(out, then);
                let block = self.below(2) == 0;
                self.body(down, in_loop, block, out);
                if block && self.below(2) == 0 {
                    self.put(out, "else ");
                    let block = self.below(2) == 0;
                    self.body(down, in_loop, block, out);
                }
            }
            10..13 => {
                let head = self.pick(&[
                    "while (a)",
                    "for (i = 1:n)",
                    "for(i=1:n:2)",
                    "for(;;)",
                    "for (i=0;i<n ; i+=1)",
                    "foreach (k in c)",
                ]);
                self.put(out, head);
                let block = self.below(2) == 0;
                self.body(down, true, block, out);
            }
            _ => self.body(down, in_loop, true, out),
        }
    }

    fn body(&mut self, depth: u32, in_loop: bool, block: bool, out: &mut String) {
        if !block {
            return self.stmt(depth, in_loop, out);
        }
        self.put(out, "{");
        for _ in 0..self.below(4) {
            self.stmt(depth, in_loop, out);
        }
        self.put(out, "}");
    }

    /// A program without faults.
    pub fn program(&mut self, statements: usize) -> String {
        let mut out = String::new();
        self.gap(&mut out);
        for _ in 0..self.below(statements) + 1 {
            match self.below(8) {
                0 => {
                    self.put(&mut out, "load \"stdsubs.sdl\"");
                }
                1 => {
                    let head = self.pick(&[
                        "subroutine arc(returned curve c, float a0)",
                        "function farray f ( )",
                        "subroutine many( farray a, curve c ... )",
                    ]);
                    self.put(&mut out, head);
                    self.body(2, false, true, &mut out);
                }
                _ => self.stmt(3, false, &mut out),
            }
        }
        out
    }
}
