// The page beside the text, with an editor that is none: what the extension sends, applies and refuses.

import assert from "node:assert";
import { mkdtempSync, mkdirSync, symlinkSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import Module from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";

const require = createRequire(import.meta.url);
const listeners = { change: [], select: [], save: [] };
const listen = (list) => (run) => (list.push(run), { dispose: () => list.splice(list.indexOf(run), 1) });
const said = [];
const panels = [];

class Range {
  constructor(a, b, c, d) {
    [this.start, this.end] = [{ line: a, character: b }, { line: c, character: d }];
  }
}

// A document with lines that end as on Windows.
function document(folder, text) {
  const lines = () => text.replace(/\r\n/g, "\n").split("\n");
  const made = {
    fileName: join(folder, "model.sdl"), languageId: "sdl", version: 1, uri: { toString: () => `file:${folder}/model.sdl` }, saved: 0,
    getText: () => text,
    save: () => (made.saved++, true),
    change: (next) => {
      text = next;
      made.version++;
      listeners.change.forEach((run) => run({ document: made, contentChanges: [{}] }));
    },
    replace: ({ start, end }, insert) => {
      const all = lines();
      const before = [...all.slice(0, start.line), all[start.line].slice(0, start.character)].join("\n");
      const after = [all[end.line].slice(end.character), ...all.slice(end.line + 1)].join("\n");
      made.change((before + insert + after).replace(/\n/g, "\r\n"));
    },
  };
  return made;
}

let active;
const vscode = {
  Range,
  Selection: class {},
  ViewColumn: { One: 1, Beside: -2 },
  TextEditorRevealType: { InCenterIfOutsideViewport: 2 },
  Uri: { file: (path) => ({ path, toString: () => `file:${path}` }) },
  WorkspaceEdit: class {
    edits = [];
    replace(_, range, insert) {
      this.edits.push([range, insert]);
    }
  },
  workspace: {
    applyEdit: async (edit) => (edit.edits.reverse().forEach(([range, insert]) => active.replace(range, insert)), true),
    onDidChangeTextDocument: listen(listeners.change),
    onDidSaveTextDocument: listen(listeners.save),
  },
  window: {
    get activeTextEditor() {
      return active && { document: active, viewColumn: 1 };
    },
    visibleTextEditors: [],
    showInformationMessage: (words) => said.push(words),
    showErrorMessage: (words) => said.push(words),
    onDidChangeTextEditorSelection: listen(listeners.select),
    createWebviewPanel: (...of) => {
      const panel = { of, sent: [], closed: [], reveals: 0, reveal: () => panel.reveals++, onDidDispose: (run) => panel.closed.push(run) };
      panel.webview = {
        cspSource: "https://webview.test",
        asWebviewUri: (uri) => ({ toString: () => `https://webview.test${uri.path}` }),
        postMessage: (message) => panel.sent.push(message),
        onDidReceiveMessage: (run) => (panel.hear = run),
      };
      panels.push(panel);
      return panel;
    },
  },
};
const load = Module._load;
Module._load = (name, ...rest) => (name === "vscode" ? vscode : load(name, ...rest));
const { view, read } = require("../src/view.js");

function folder() {
  const made = mkdtempSync(join(tmpdir(), "moldloft-view-"));
  mkdirSync(join(made, "page"), { recursive: true });
  for (const name of ["index.html", "worker.js", "engine.wasm.xz", "page.js", "page.css"]) writeFileSync(join(made, "page", name), "");
  return made;
}

test("a program is shown beside its text, and only a program", () => {
  active = undefined;
  view({ extensionPath: "/nowhere" });
  assert.match(said.pop(), /open a program/);
  active = document("/nowhere/at/all", "");
  view({ extensionPath: "/nowhere/at/all" });
  assert.match(said.pop(), /make engine/);
  assert.equal(panels.length, 0);
});

test("the page has the text as data, and may ask nobody", () => {
  const extensionPath = folder();
  active = document(extensionPath, 'print("</script><b>");\r\nAbsPoint P(1, 2, 3);\r\n');
  view({ extensionPath });
  view({ extensionPath });
  assert.equal(panels.length, 1);
  const [panel] = panels;
  assert.equal(panel.reveals, 1);
  const { html } = panel.webview;
  const policy = html.match(/Content-Security-Policy" content="([^"]*)"/)[1];
  assert.match(policy, /default-src 'none'/);
  assert.doesNotMatch(policy, /\*|http:|unsafe-eval'(?<!wasm-unsafe-eval')/);
  assert.equal(html.split("</script>").length, 3, "the text ends no element");
  const data = JSON.parse(html.match(/id="moldloft-model"[^>]*>(.*?)<\/script>/s)[1]);
  assert.equal(data.hello.text, 'print("</script><b>");\nAbsPoint P(1, 2, 3);\n');
  assert.deepEqual(panel.of[3].localResourceRoots.map((u) => u.path.startsWith(extensionPath)), [true, true]);
});

test("edits become the document's, old ones are refused, other changes are told", async () => {
  const [panel] = panels;
  panel.hear({ kind: "ready" });
  assert.equal(panel.sent.at(-1).version, 1);
  const edit = (version) => ({ kind: "edit", version, changes: [{ from: { line: 1, character: 11 }, to: { line: 1, character: 12 }, insert: "4.5" }] });
  await panel.hear(edit(1));
  assert.equal(active.getText().split("\r\n")[1], "AbsPoint P(4.5, 2, 3);");
  assert.equal(panel.sent.at(-1).version, 2);
  await panel.hear(edit(1));
  assert.equal(active.getText().split("\r\n")[1], "AbsPoint P(4.5, 2, 3);", "what was made of an older text is not applied");
  assert.equal(panel.sent.at(-1).refused, true);
  active.change("AbsPoint Q(0, 0, 0);\r\n");
  assert.deepEqual(panel.sent.at(-1), { kind: "text", text: "AbsPoint Q(0, 0, 0);\n", version: 3, refused: false });
  panel.hear({ kind: "save" });
  assert.equal(active.saved, 1);
  panel.closed.forEach((run) => run());
  assert.equal(listeners.change.length, 0);
});

test("files are read beside the model and nowhere else", () => {
  const base = mkdtempSync(join(tmpdir(), "moldloft-read-"));
  const inside = join(base, "in");
  mkdirSync(join(inside, "parts"), { recursive: true });
  writeFileSync(join(base, "secret.sdl"), "no");
  writeFileSync(join(inside, ".hidden"), "no");
  writeFileSync(join(inside, "a.sdl"), "a");
  writeFileSync(join(inside, "parts", "b.sdl"), "b");
  writeFileSync(join(inside, "parts", "c.sdl"), "c");
  symlinkSync(join(base, "secret.sdl"), join(inside, "link.sdl"));
  const asked = [["a.sdl", null], ["parts/b.sdl", null], ["c.sdl", "parts/b.sdl"], ["../secret.sdl", null], [join(base, "secret.sdl"), null], [".hidden", null], ["link.sdl", null], ["gone.sdl", null]];
  const found = read({ fileName: join(inside, "model.sdl") }, asked);
  assert.deepEqual(found.map((f) => [f.path, f.name, Buffer.from(f.data, "base64").toString()]), [["a.sdl", "a.sdl", "a"], ["parts/b.sdl", "parts/b.sdl", "b"], ["c.sdl", "parts/c.sdl", "c"]]);
});
