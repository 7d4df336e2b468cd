// Starts the language server and connects the editor to it.
"use strict";

const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

function activate(context) {
  const given = vscode.workspace.getConfiguration("moldloft").get("server");
  const server = given ? { command: given, args: [] } : { command: "moldloft", args: ["lsp"] };
  client = new LanguageClient(
    "moldloft",
    "Moldloft",
    { run: server, debug: server },
    { documentSelector: [{ language: "sdl" }] },
  );
  context.subscriptions.push({ dispose: () => client.stop() });
  return client.start();
}

function deactivate() {
  return client ? client.stop() : undefined;
}

module.exports = { activate, deactivate };
