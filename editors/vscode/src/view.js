// The workbench's page beside the text: its engine runs in the page, the text stays this editor's document.
"use strict";

const fs = require("fs");
const path = require("path");
const vscode = require("vscode");

// The most bytes of a file that a model reads.
const LARGEST = 64 << 20;

// The folder with the built page and the engine for pages: inside of a released extension, else in the checkout.
function parts(context) {
  const inside = path.join(context.extensionPath, "page");
  const checkout = path.join(context.extensionPath, "..", "..", "python", "moldloft", "workbench");
  for (const [page, engine] of [
    [inside, inside],
    [path.join(checkout, "page"), path.join(checkout, "wasm")],
  ]) {
    const packed = fs.existsSync(engine) ? fs.readdirSync(engine).find((name) => name.startsWith("engine.wasm.")) : undefined;
    if (packed && fs.existsSync(path.join(page, "index.html"))) return { page, engine: path.join(engine, packed) };
  }
  return undefined;
}

// Data in a page: no parser of pages takes it for anything else.
function asData(value) {
  return JSON.stringify(value).replace(/</g, "\\u003c").replace(/\u2028/g, "\\u2028").replace(/\u2029/g, "\\u2029");
}

function plain(document) {
  return document.getText().replace(/\r\n/g, "\n");
}

// The page for a webview: scripts of the extension and WebAssembly, a worker of a blob, no other address.
function html(webview, found, document) {
  const uri = (...names) => webview.asWebviewUri(vscode.Uri.file(path.join(...names))).toString();
  const nonce = require("crypto").randomBytes(18).toString("base64url");
  const source = webview.cspSource;
  const policy = [
    "default-src 'none'",
    `script-src 'nonce-${nonce}' ${source} 'wasm-unsafe-eval' blob:`,
    "worker-src blob:",
    `connect-src ${source}`,
    `style-src ${source} 'unsafe-inline'`,
    "img-src blob: data:",
    "base-uri 'none'",
    "form-action 'none'",
  ].join("; ");
  const data = {
    hello: { kind: "hello", name: path.basename(document.fileName), text: plain(document), document: document.version, version: 0, dirty: false },
    frames: {},
    files: [],
    host: { worker: uri(found.page, "worker.js"), engine: uri(found.engine) },
  };
  return `<!doctype html>
<html lang="en">
  <head>
    <meta charset="utf-8" />
    <meta http-equiv="Content-Security-Policy" content="${policy}" />
    <meta name="viewport" content="width=device-width, initial-scale=1" />
    <meta name="nonce" content="" />
    <title>Moldloft</title>
    <link rel="stylesheet" href="${uri(found.page, "page.css")}" />
  </head>
  <body>
    <div id="app"></div>
    <script type="application/json" id="moldloft-model" nonce="${nonce}">${asData(data)}</script>
    <script type="module" nonce="${nonce}" src="${uri(found.page, "page.js")}"></script>
  </body>
</html>`;
}

const range = (from, to) => new vscode.Range(from.line, from.character, to.line, to.character);

// The files that a model asked for, those beside it or below only: [[path, asker], ...].
function read(document, asked) {
  const folder = path.dirname(document.fileName);
  let root;
  try {
    root = fs.realpathSync(folder);
  } catch {
    return [];
  }
  const found = [];
  for (const [name, asker] of asked) {
    const beside = asker && asker !== path.basename(document.fileName) ? path.dirname(path.join(root, asker)) : root;
    for (const base of [beside, root]) {
      try {
        const file = fs.realpathSync(path.resolve(base, name));
        const inside = path.relative(root, file);
        const hidden = inside.split(path.sep).some((part) => part.startsWith("."));
        const state = fs.statSync(file);
        if (!inside || hidden || path.isAbsolute(inside) || !state.isFile() || state.size > LARGEST) continue;
        found.push({ path: name, from: asker, name: inside.split(path.sep).join("/"), data: fs.readFileSync(file).toString("base64") });
        break;
      } catch {
        // It is not there: the message of the engine stays.
      }
    }
  }
  return found;
}

// A panel with the model of a document; the document is the one truth of the text.
class Panel {
  constructor(panel, document, found) {
    this.panel = panel;
    this.document = document;
    this.applying = Promise.resolve();
    this.ready = false;
    this.watched = [];
    panel.webview.onDidReceiveMessage((message) => this.hear(message));
    panel.webview.html = html(panel.webview, found, document);
    const changes = vscode.workspace.onDidChangeTextDocument((event) => {
      if (event.document === this.document && event.contentChanges.length) this.tell();
    });
    const cursor = vscode.window.onDidChangeTextEditorSelection((event) => {
      if (event.textEditor.document !== this.document || !this.ready) return;
      const { line, character } = event.selections[0].active;
      panel.webview.postMessage({ kind: "cursor", line, character });
    });
    // What a model reads may change beside it.
    const saved = vscode.workspace.onDidSaveTextDocument((other) => {
      if (other !== this.document && this.watched.length) this.files(this.watched);
    });
    panel.onDidDispose(() => [changes, cursor, saved].forEach((d) => d.dispose()));
  }

  tell(refused = false) {
    if (this.ready) this.panel.webview.postMessage({ kind: "text", text: plain(this.document), version: this.document.version, refused });
  }

  files(asked) {
    const files = read(this.document, asked);
    if (files.length) this.panel.webview.postMessage({ kind: "files", files });
  }

  hear(message) {
    switch (message && message.kind) {
      case "ready":
        this.ready = true;
        return this.tell();
      case "edit":
        this.applying = this.applying.then(() => this.edit(message));
        return this.applying;
      case "show":
        return this.show(message);
      case "save":
        return this.document.save();
      case "undo":
      case "redo":
        return this.history(message.kind);
      case "read":
        this.watched = [...new Map([...this.watched, ...message.files].map((one) => [JSON.stringify(one), one])).values()];
        return this.files(message.files);
      case "download":
        return this.download(message);
      default:
        return undefined;
    }
  }

  // An edit that the page made of an older text is not guessed at: the page gets the text and says so.
  async edit(message) {
    if (message.version !== this.document.version) return this.tell(true);
    const edit = new vscode.WorkspaceEdit();
    for (const { from, to, insert } of message.changes) edit.replace(this.document.uri, range(from, to), String(insert));
    const done = await vscode.workspace.applyEdit(edit);
    if (!done) this.tell(true);
  }

  async history(command) {
    await vscode.window.showTextDocument(this.document, { viewColumn: this.column() });
    await vscode.commands.executeCommand(command);
  }

  column() {
    const editor = vscode.window.visibleTextEditors.find((one) => one.document === this.document);
    return editor ? editor.viewColumn : vscode.ViewColumn.One;
  }

  show(message) {
    const editor = vscode.window.visibleTextEditors.find((one) => one.document === this.document);
    if (!editor) return undefined;
    const place = range(message.from, message.to);
    editor.revealRange(place, vscode.TextEditorRevealType.InCenterIfOutsideViewport);
    if (!message.focus) return undefined;
    editor.selection = new vscode.Selection(place.start, place.start);
    return vscode.window.showTextDocument(this.document, { viewColumn: editor.viewColumn, selection: place });
  }

  async download(message) {
    const name = path.basename(String(message.name));
    const target = await vscode.window.showSaveDialog({ defaultUri: vscode.Uri.file(path.join(path.dirname(this.document.fileName), name)) });
    if (target) await vscode.workspace.fs.writeFile(target, Buffer.from(String(message.data), "base64"));
  }
}

const panels = new Map();

function view(context) {
  const editor = vscode.window.activeTextEditor;
  if (!editor || editor.document.languageId !== "sdl") {
    return vscode.window.showInformationMessage("Moldloft: open a program (*.sdl) first");
  }
  const { document } = editor;
  const key = document.uri.toString();
  if (panels.has(key)) return panels.get(key).panel.reveal();
  const found = parts(context);
  if (!found) {
    return vscode.window.showErrorMessage("Moldloft: this extension was made without the page or its engine: `make web` and `make engine` in the clone build them");
  }
  const roots = [vscode.Uri.file(found.page), vscode.Uri.file(path.dirname(found.engine))];
  const options = { enableScripts: true, retainContextWhenHidden: true, localResourceRoots: roots };
  const title = `Model of ${path.basename(document.fileName)}`;
  const made = vscode.window.createWebviewPanel("moldloft.view", title, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true }, options);
  panels.set(key, new Panel(made, document, found));
  made.onDidDispose(() => panels.delete(key));
  return undefined;
}

module.exports = { view, html, read, parts };
