// Shared by the scripts that make tables: puts a table between <!-- NAME --> and <!-- /NAME --> of a document.
'use strict';
const fs = require('fs');
const path = require('path');

const root = path.dirname(__dirname);

// `document` is relative to the repository; sections are {NAME: text}.
function fillDocument(document, sections) {
  const file = path.join(root, document);
  let text = fs.readFileSync(file, 'utf8');
  for (const [name, content] of Object.entries(sections)) {
    const begin = `<!-- ${name} -->`;
    const from = text.indexOf(begin);
    const to = text.indexOf(`<!-- /${name} -->`, from);
    if (from < 0 || to < 0) throw new Error(`${document}: there is no ${begin} ... <!-- /${name} -->`);
    text = `${text.slice(0, from)}${begin}\n${content.trimEnd()}\n${text.slice(to)}`;
  }
  fs.writeFileSync(file, text);
}

module.exports = {fillDocument, root};
