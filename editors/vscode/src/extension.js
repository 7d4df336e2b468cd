// Starts the language server and connects the editor to it; shows models beside their texts.
"use strict";

const fs = require("fs");
const path = require("path");
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");
const { view } = require("./view");

let client;

// The server of the settings, else the one inside of the extension, else that of the installed package.
function chosen(context) {
  const given = vscode.workspace.getConfiguration("moldloft").get("server");
  if (given) return { command: given, args: [] };
  const name = process.platform === "win32" ? "moldloft-lsp.exe" : "moldloft-lsp";
  const inside = path.join(context.extensionPath, "server", name);
  if (fs.existsSync(inside)) return { command: inside, args: [] };
  return { command: "moldloft", args: ["lsp"] };
}

function activate(context) {
  const server = chosen(context);
  client = new LanguageClient(
    "moldloft",
    "Moldloft",
    { run: server, debug: server },
    { documentSelector: [{ language: "sdl" }] },
  );
  context.subscriptions.push(vscode.commands.registerCommand("moldloft.view", () => view(context)));
  context.subscriptions.push({ dispose: () => client.stop() });
  return client.start();
}

function deactivate() {
  return client ? client.stop() : undefined;
}

module.exports = { activate, deactivate };
