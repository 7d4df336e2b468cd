"""Random set programs: trees of every operator with ordinary, thin, huge and coincident parts.

Beside `random_sets`, whose bodies are those that engineers draw, these are what a program makes.
"""

from __future__ import annotations

import random

import random_sets

OPERATORS = ("|", "&", "-")


class OddSets:
    """Texts of sets, with the lines that they need before them."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.lines: list[str] = []

    def size(self) -> str:
        """A length: mostly ordinary, at times thin, large, 0 or of the wrong sign."""
        r = self.rng
        ordinary = r.uniform(0.05, 1.5)
        odd = (1e-4, 1e-3, 0.01, 0.02, 1.0, 0.5, 30.0, 1e4, 0.0, -0.3, 1e-12)
        return f"{ordinary if r.random() < 0.8 else r.choice(odd):.4g}"

    def place(self) -> str:
        """A point, at times one on which several parts agree."""
        r = self.rng
        values = [r.choice((0.0, 0.5, 1.0, -1.0)) if r.random() < 0.3 else r.uniform(-1, 1)
                  for _ in range(3)]  # fmt: skip
        return "{" + ", ".join(f"{v:.4g}" for v in values) + "}"

    def axis(self) -> str:
        name = f"l{len(self.lines)}"
        self.lines.append(f"Line {name}({self.place()}, {self.place()});")
        return name

    def primitive(self) -> str:
        p, s = self.place, self.size
        match self.rng.randrange(9):
            case 0 | 1:
                return f"set(sphere({p()}, {s()}))"
            case 2 | 3:
                a, b = ([self.rng.uniform(-1, 1) for _ in range(3)] for _ in range(2))
                # Thin in one direction now and then.
                if self.rng.random() < 0.3:
                    k = self.rng.randrange(3)
                    b[k] = a[k] + float(s()) * 0.02
                low, high = (
                    ", ".join(f"{f(x, y):.4g}" for x, y in zip(a, b, strict=True))
                    for f in (min, max)
                )
                return f"cuboid({{{low}}}, {{{high}}})"
            case 4:
                return (
                    f"(set(cylinder({self.axis()}, {s()})) & cuboid({{-1, -1, -1}}, {{1, 1, 1}}))"
                )
            case 5:
                return (
                    f"(set(cone({self.axis()}, {self.rng.uniform(0.1, 1.5):.3g})) & {self.ball()})"
                )
            case 6:
                return f"set(torus({self.axis()}, {s()}, {s()}))"
            case 7:
                return f"({self.ball()} & set(plane({p()}, {p()})))"
            case _:
                return f"tetrahedron({p()}, {p()}, {p()}, {p()})"

    def ball(self) -> str:
        return f"set(sphere({{0, 0, 0}}, {self.rng.uniform(0.8, 2):.3g}))"

    def tree(self, depth: int) -> str:
        """A set of operators nested so deep."""
        r = self.rng
        if depth == 0 or r.random() < 0.15:
            return self.primitive()
        a = self.tree(depth - 1)
        if r.random() < 0.55:
            return f"({a} {r.choice(OPERATORS)} {self.tree(depth - 1)})"
        s = self.size
        match r.randrange(14):
            case 0:
                return f"set_chamfer({a}, {s()})"
            case 1:
                return f"set_round({a}, {s()})"
            case 2:
                return f"set_shell({a}, {s()})"
            case 3:
                return f"set_offset({a}, {s()})"
            case 4:
                return f"thin({a})"
            case 5:
                return f"set_fillet({a}, {self.tree(depth - 1)}, {s()})"
            case 6:
                return f"smooth_union({a}, {self.tree(depth - 1)}, {s()})"
            case 7:
                return f"translated({a}, {self.place()})"
            case 8:
                return f"turned({a}, {self.axis()}, {r.uniform(0, 3):.3g})"
            case 9:
                return f"scaled({a}, {s()})"
            case 10:
                return f"repeated({a}, {self.place()}, {r.choice((2, 3, 7, 40))})"
            case 11:
                return f"circular_array({a}, {self.axis()}, {r.choice((2, 3, 7, 40))})"
            case 12:
                return f"twisted({a}, {s()})"
            case _:
                # The same set several times.
                name = f"t{len(self.lines)}"
                self.lines.append(f"set {name} = {a};")
                return f"({name} {r.choice(OPERATORS)} translated({name}, {self.place()}))"


def program(rng: random.Random) -> str:
    """A text of a set `s` and its body `b`, by the default depth or another one."""
    if rng.random() < 0.3:
        text = random_sets.program(rng.randrange(10**6))
        numbers = [at for at, c in enumerate(text) if c.isdigit() and text[at - 1] == "."]
        # A digit changed: parts that nearly coincide, or are thin.
        at = rng.choice(numbers)
        return text[:at] + rng.choice("0159") + text[at + 1 :]
    made = OddSets(rng)
    text = made.tree(rng.choice((1, 2, 2, 3, 3, 4)))
    box = "" if rng.random() < 0.5 else ", {-2, -2, -2}, {2, 2, 2}"
    depth = "" if rng.random() < 0.7 else f", depth = {rng.randrange(2, 8)}"
    return "\n".join([*made.lines, f"set s = {text};", f"SetBody b(s{box}{depth});"])
