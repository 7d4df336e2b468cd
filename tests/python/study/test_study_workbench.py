"""Studies in the workbench: made, started, watched, browsed, and a variant taken into the text."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
from moldloft import study
from moldloft.errors import Error
from moldloft.workbench.studies import Studies
from page_in_browser import Bench, in_browser

HULL = """param float beam = 2 in [1, 4];
param float draft = 1 in [0.5, 2];
param float rake = 0.3;
AbsPoint A(0, 0, -draft);
AbsPoint B(3, 0.5 * beam, -0.7);
AbsPoint C(6 + rake, 0, 0);
AbsPoint D(0, 0.3, 0.5);
AbsPoint E(3, beam * draft, 0.4);
AbsPoint F(6, 0.1, 0.6);
BCurve a({A, B, C});
BCurve b({D, E, F});
CLoftSurf hull({a, b}, divisions = {6, 9});
if (beam > 3.6) { print undefined_name; }
"""

ASKED = {
    "kind": "study_make",
    "inputs": {"beam": None, "draft": None, "rake": [0.1, 0.5]},
    "outputs": ["hull.area", "mesh.area"],
    "plan": "sobol",
    "count": 16,
}


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "hull.sdl"
    path.write_text(HULL)
    return path


def ask(studies: Studies, kind: str, *, dirty: bool = False, **more: Any) -> dict[str, Any]:
    return asyncio.run(studies.answer({"kind": kind, **more}, dirty=dirty))


def test_a_study_is_made_beside_the_model(model: Path) -> None:
    studies = Studies(model)
    assert ask(studies, "studies") == {"studies": []}
    # Studies of other models, broken ones and other files are not of this one.
    (model.parent / "other.toml").write_text('model = "else.sdl"\n')
    (model.parent / "broken.toml").write_text("model = \n")
    name = studies.make(ASKED)
    assert name == "hull-study.toml" and studies.make(ASKED) == "hull-study-2.toml"
    read = study.read(model.parent / name)
    assert [(i.name, i.low, i.high) for i in read.inputs] == [
        ("beam", None, None), ("draft", None, None), ("rake", 0.1, 0.5),
    ]  # fmt: skip
    assert read.outputs == {"area": "hull.area", "mesh.area": "mesh.area"}
    assert (read.plan.method, read.plan.count) == ("sobol", 16)
    (model.parent / "wrong.toml").write_text('model = "hull.sdl"\n[inputs]\n')
    found = {each["name"]: each for each in ask(studies, "studies")["studies"]}
    assert set(found) == {name, "hull-study-2.toml", "wrong.toml"}
    assert "needs an input" in found["wrong.toml"]["error"]
    assert found[name]["inputs"] == ["beam", "draft", "rake"] and found[name]["error"] == ""


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"inputs": {}}, "an input at least"),
        ({"outputs": []}, "an output at least"),
        ({"plan": "guess"}, "`guess` is no plan"),
        ({"count": 0}, "1 to 1 000 000"),
        ({"count": True}, "1 to 1 000 000"),
        ({"inputs": {"beam": [2, 1]}}, "the lower one first"),
        ({"inputs": {"beam": [1]}}, r"\[low, high\]"),
        ({"inputs": {"beam": ["x", "y"]}}, "two numbers"),
        ({"inputs": {"beam": [0, 1e400]}}, "finite"),
    ],
)
def test_what_cannot_be_made_is_said(model: Path, given: dict[str, Any], said: str) -> None:
    with pytest.raises(Error, match=said):
        Studies(model).make({**ASKED, **given})
    assert not list(model.parent.glob("*.toml"))


def test_names_of_files_are_those_of_studies_of_the_model(model: Path) -> None:
    studies = Studies(model)
    for name in ("../x.toml", "hull.sdl", None, 3, "/etc/hosts"):
        with pytest.raises(Error, match="there is no study"):
            ask(studies, "study_state", name=name)


def test_a_run_is_started_watched_and_stopped(model: Path) -> None:
    studies = Studies(model)
    name = studies.make({**ASKED, "count": 64})

    async def session() -> tuple[dict[str, Any], ...]:
        async def answer(kind: str, *, dirty: bool = False, **more: Any) -> dict[str, Any]:
            return await studies.answer({"kind": kind, "name": name, **more}, dirty=dirty)

        with pytest.raises(Error, match="save the text first"):
            await answer("study_run", dirty=True)
        with pytest.raises(Error, match="number of processes"):
            await answer("study_run", processes=0)
        await answer("study_run")
        with pytest.raises(Error, match="is running"):
            await answer("study_run")
        while not sum((state := await answer("study_state"))["counts"].values()):
            await asyncio.sleep(0.05)
        await answer("study_stop")
        stopped = await answer("study_state")
        await answer("study_run")
        while (ended := await answer("study_state"))["running"]:
            await asyncio.sleep(0.05)
        await studies.close()
        return state, stopped, ended

    state, stopped, ended = asyncio.run(session())
    assert state["running"] and state["planned"] == 64
    assert not stopped["running"] and 0 < sum(stopped["counts"].values()) <= 64
    assert stopped["failed"] == "" == ended["failed"]
    assert sum(ended["counts"].values()) == 64 and ended["counts"]["refused"] > 0
    # The rows of the table, in the requested order.
    with study.Store(model.parent / "hull-study.sqlite") as store:
        table = store.results()
    page = studies.rows(
        name, {"sort": "area", "down": True, "state": "done", "x": "beam", "y": "area"}
    )
    assert page["count"] == table.done.sum() and page["inputs"] == ["beam", "draft", "rake"]
    best = np.argsort(-table.outputs["area"][table.done], kind="stable")
    assert [r["row"] for r in page["rows"]] == np.flatnonzero(table.done)[best].tolist()
    first = page["rows"][0]
    assert first["numbers"][3] == np.nanmax(table.outputs["area"])
    assert sorted(p[0] for p in page["points"]) == np.flatnonzero(table.done).tolist()
    refused = studies.rows(name, {"state": "refused"})["rows"]
    assert all("undefined_name" in r["message"] and r["numbers"][3] is None for r in refused)
    assert all(r["numbers"][0] > 3.6 for r in refused)
    assert studies.rows(name, {"first": 60})["rows"][0]["row"] == 60


def test_a_run_that_fails_says_why(model: Path) -> None:
    studies = Studies(model)
    name = studies.make({**ASKED, "outputs": ["hull.volumen"]})

    async def session() -> dict[str, Any]:
        await studies.answer({"kind": "study_run", "name": name}, dirty=False)
        while (state := await studies.answer({"kind": "study_state", "name": name}, dirty=False))[
            "running"
        ]:
            await asyncio.sleep(0.05)
        await studies.close()
        return state

    assert "volumen" in asyncio.run(session())["failed"]


@in_browser
def test_a_study_by_hand(model: Path, browser: Any) -> None:
    """From nothing to a variant in the text, by the page alone."""
    bench = Bench(model, browser, 0.2)
    page = bench.page
    try:
        bench.until(lambda: bench.page.evaluate("() => window.moldloft.model.watched.length"))
        page.get_by_role("tab", name="Studies").click()
        form = page.get_by_role("group", name="new study")
        form.wait_for()
        form.get_by_label("rake").check()
        form.get_by_label("cases or levels").fill("16")
        form.get_by_role("button", name="Make").click()
        page.get_by_role("button", name="Start", exact=True).click()
        table = page.locator(".studies-table tbody tr")
        bench.until(lambda: table.count() == 16, 60)
        bench.until(lambda: page.locator(".studies-progress").inner_text().startswith("16 of 16"))
        (path,) = model.parent.glob("*.toml")
        with study.Store(path.with_suffix(".sqlite")) as store:
            results = store.results()
        column = next(iter(results.outputs))
        # Sorted by a column: the best row is first.
        page.get_by_role("button", name=column, exact=True).click()
        best = int(np.nanargmin(results.outputs[column]))
        bench.until(lambda: table.first.get_attribute("data-row") == str(best))
        before = bench.text()
        table.first.hover()
        bench.hand("studies.settled()")
        values = {name: float(c[best]) for name, c in results.inputs.items()}
        assert {name: bench.param(name) for name in values} == values
        # The picture has the shape of the row; the text is as it was.
        there = moldloft.loads(before)
        there.set(values)
        seen = np.array(bench.hand("positions('hull')"), dtype=np.float64).reshape(-1, 3)
        extent = np.ptp(np.asarray(there.mesh().vertices), axis=0)
        assert np.allclose(np.ptp(seen, axis=0), extent, rtol=1e-4)
        assert not np.allclose(extent, np.ptp(moldloft.loads(before).mesh().vertices, axis=0))
        assert bench.text() == before
        page.mouse.move(30, 30)
        bench.hand("studies.settled()")
        assert bench.param("beam") == 2 and bench.param("rake") == 0.3
        page.get_by_role("button", name=f"take case {best + 1} into the text").click()
        bench.until(lambda: bench.text() != before)
        bench.hand("settled()")
        taken = moldloft.loads(bench.text())
        assert np.allclose([taken[name] for name in values], list(values.values()), rtol=1e-12)
        page.keyboard.press("Control+z")
        bench.until(lambda: bench.text() == before)
        assert not bench.faults
    finally:
        bench.close()
