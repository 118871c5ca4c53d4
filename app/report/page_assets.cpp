#include "app/report/page_assets.hpp"

namespace fascia::app {

const char* const page_style = R"css(
:root { color-scheme: light dark; --ground: #fff; --ink: #1c1f22; --soft: #5b6369; --rule: #d5d9dc; --face: #f3f5f6;
  --link: #0059a3; --right: #dcefe2; --refused: #e6e8ea; --stopped: #fdebc8; --doubtful: #f6d9b8; --wrong: #f9d5d0; --strong: #b3261e; }
@media screen and (prefers-color-scheme: dark) {
  :root { --ground: #14171a; --ink: #e6e8ea; --soft: #a3abb1; --rule: #394147; --face: #1f2428; --link: #7cc0ff;
    --right: #1d4a30; --refused: #353c42; --stopped: #5c4512; --doubtful: #70391c; --wrong: #6b231d; --strong: #ff9a91; }
  .plot .ground { fill: var(--ground); }
  .plot text { fill: var(--ink); }
  .plot .halo { stroke: var(--ground); }
  .plot .grid { stroke: #3a4248; }
  .plot .small { stroke: #262c31; }
  .plot .frame, .plot .across { stroke: #a3abb1; }
  .plot .ring { stroke: var(--ink); }
  .plot .arrow { fill: var(--ink); }
  .plot .s0 { stroke: #56b4e9; } .plot .s0.full { fill: #56b4e9; }
  .plot .s1 { stroke: #ff8a3c; } .plot .s1.full { fill: #ff8a3c; }
  .plot .s2 { stroke: #f2f2f2; } .plot .s2.full { fill: #f2f2f2; }
  .plot .s3 { stroke: #a97bff; } .plot .s3.full { fill: #a97bff; }
  .plot .s4 { stroke: #4fd08a; } .plot .s4.full { fill: #4fd08a; }
  .plot .s5 { stroke: #c98a6b; } .plot .s5.full { fill: #c98a6b; }
  .plot .hollow { fill: var(--ground); }
}
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem 1.25rem 3rem; max-width: 68rem; background: var(--ground); color: var(--ink);
  font: 1rem/1.5 system-ui, "Segoe UI", Roboto, Helvetica, Arial, sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 1rem 0; }
h2 { font-size: 1.3rem; margin: 2.2rem 0 .6rem; padding-top: .5rem; border-top: 1px solid var(--rule); }
h3 { font-size: 1.08rem; margin: 1.5rem 0 .4rem; }
h2 a, h3 a { color: inherit; text-decoration: none; }
h2 a:hover, h3 a:hover { text-decoration: underline; }
p, ul { margin: .6rem 0; max-width: 46rem; }
a { color: var(--link); }
.contents ul { columns: 16rem auto; padding-left: 1.2rem; }
.notice { padding: .6rem .9rem; border-left: .3rem solid var(--strong); background: var(--face); }
figure { margin: 1rem 0; }
figcaption, caption, footer { color: var(--soft); font-size: .9rem; text-align: left; }
figcaption { max-width: 46rem; }
caption { padding: .3rem 0; caption-side: top; }
figure img { max-width: 100%; height: auto; border: 1px solid var(--rule); }
.plot { display: block; max-width: 100%; height: auto; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .6rem; text-align: left; vertical-align: top; border-bottom: 1px solid var(--rule); }
td { max-width: 26rem; }
.table th { background: var(--face); padding: 0; vertical-align: bottom; }
.table th button { display: block; width: 100%; padding: .35rem .6rem; border: 0; background: none; color: inherit;
  font: inherit; font-weight: 600; text-align: inherit; cursor: pointer; }
.table th button::after { content: " ↕"; color: var(--soft); font-weight: 400; }
.table th[aria-sort=ascending] button::after { content: " ↑"; color: inherit; }
.table th[aria-sort=descending] button::after { content: " ↓"; color: inherit; }
.table .scroll { max-height: min(44rem, 85vh); overflow: auto; width: fit-content; max-width: 100%; }
.table th { position: sticky; top: 0; z-index: 1; }
.number { text-align: right; }
td.number { white-space: nowrap; }
.unit { color: var(--soft); font-weight: 400; white-space: nowrap; }
.table tbody tr:hover { background: var(--face); }
.filter input { font: inherit; padding: .2rem .4rem; width: 16rem; max-width: 60vw; }
.filter output { color: var(--soft); font-size: .9rem; }
.state { display: inline-block; min-width: 1.4em; padding: 0 .2em; text-align: center; font-weight: 600; border-radius: .2rem;
  background: var(--refused); }
.state.right, .map td.right { background: var(--right); }
.state.refused, .map td.refused { background: var(--refused); }
.state.stopped, .map td.stopped { background: var(--stopped); }
.state.doubtful, .map td.doubtful { background: var(--doubtful); }
.state.wrong, .map td.wrong { background: var(--wrong); outline: 2px solid var(--strong); outline-offset: -2px; }
.state.none, .map td.none { background: none; color: var(--soft); }
.states { display: flex; flex-wrap: wrap; gap: .3rem 1.2rem; padding: 0; list-style: none; font-size: .9rem; }
.map th { font-weight: 500; }
.map tbody th { position: sticky; left: 0; background: var(--ground); z-index: 1; max-width: 40vw; }
.map td { padding: 0; border: 1px solid var(--ground); text-align: center; vertical-align: middle; min-width: 2.4rem; }
.map thead th { vertical-align: bottom; }
.map td button { width: 100%; min-height: 2rem; border: 0; background: none; color: inherit; font: inherit; font-weight: 600;
  cursor: pointer; }
.map td button[aria-pressed=true] { outline: 2px solid var(--link); outline-offset: -2px; }
.chosen { position: sticky; bottom: 0; z-index: 2; margin: .6rem 0; padding: .6rem .9rem; border: 1px solid var(--rule); background: var(--face); }
.chosen p { white-space: pre-line; margin: 0; }
.command { display: flex; align-items: flex-start; gap: .5rem; margin: .6rem 0; }
.command pre { flex: 1; min-width: 0; margin: 0; padding: .5rem .7rem; background: var(--face); overflow-x: auto;
  font: .88rem/1.45 ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; }
.command button { font: inherit; font-size: .85rem; padding: .3rem .7rem; cursor: pointer; }
details { margin: .6rem 0; padding: .3rem .8rem; border: 1px solid var(--rule); border-radius: .3rem; }
summary { cursor: pointer; font-weight: 600; }
footer { margin-top: 3rem; padding-top: .6rem; border-top: 1px solid var(--rule); white-space: pre-line; }
:focus-visible { outline: 2px solid var(--link); outline-offset: 1px; }
@media screen and (max-width: 40rem) {
  body { padding: .5rem .8rem 2rem; }
  .plot { max-width: none; }
  th, td { padding: .2rem .4rem; }
}
@media print {
  body { max-width: none; padding: 0; font-size: 10pt; }
  .filter, .command button { display: none; }
  .table th button::after { content: ""; }
  .scroll, .table .scroll { overflow: visible; max-height: none; }
  .table th { position: static; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  figure, tr, .chosen { break-inside: avoid; }
  h2, h3 { break-after: avoid; }
  thead { display: table-header-group; }
}
)css";

const char* const page_script = R"js(
'use strict';
(() => {
  const words = new Intl.Collator('en', { numeric: true, sensitivity: 'base' });

  const key_of = (cell, numeric) => {
    if (!numeric) return cell.textContent;
    return cell.dataset.value === undefined ? null : Number(cell.dataset.value);
  };

  // Cells without a value come last, up and down.
  const sort = (head) => {
    const body = head.closest('table').tBodies[0];
    const numeric = head.classList.contains('number');
    const down = head.getAttribute('aria-sort') === 'ascending';
    const rows = Array.from(body.rows, (row) => ({ row, key: key_of(row.cells[head.cellIndex], numeric) }));
    rows.sort((a, b) => {
      if (a.key === null || b.key === null) return (a.key === null) - (b.key === null);
      const order = numeric ? a.key - b.key : words.compare(a.key, b.key);
      return down ? -order : order;
    });
    for (const other of head.parentNode.cells) other.setAttribute('aria-sort', 'none');
    head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
    body.append(...rows.map((entry) => entry.row));
  };

  const copy = async (text, button) => {
    let done = true;
    try {
      await navigator.clipboard.writeText(text);
    } catch {  // pages of a file may be kept from the clipboard
      const field = document.createElement('textarea');
      field.value = text;
      document.body.append(field);
      field.select();
      done = document.execCommand('copy');
      field.remove();
    }
    button.textContent = done ? 'Copied' : 'Not copied';
    setTimeout(() => { button.textContent = 'Copy'; }, 1500);
  };

  const add_command = (parent, text) => {
    const box = document.createElement('div');
    box.className = 'command';
    const pre = document.createElement('pre');
    pre.textContent = text;
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = 'Copy';
    button.addEventListener('click', () => copy(text, button));
    box.append(pre, button);
    parent.append(box);
  };

  const choose = (map, button) => {
    const box = map.querySelector('.chosen');
    for (const other of map.querySelectorAll('[aria-pressed=true]')) other.setAttribute('aria-pressed', 'false');
    button.setAttribute('aria-pressed', 'true');
    const text = document.createElement('p');
    text.textContent = button.title;
    box.replaceChildren(text);
    if (button.dataset.command) add_command(box, button.dataset.command);
    if (button.dataset.anchor) {
      const link = document.createElement('a');
      link.href = '#' + button.dataset.anchor;
      link.textContent = 'More';
      box.append(link);
    }
    box.hidden = false;
  };

  const filter_rows = (rows, texts, field, count) => {
    const wanted = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    rows.forEach((row, i) => {
      row.hidden = !wanted.every((word) => texts[i].includes(word));
      shown += row.hidden ? 0 : 1;
    });
    count.textContent = wanted.length ? shown + ' of ' + rows.length : '';
  };

  for (const head of document.querySelectorAll('.table th')) head.firstChild.addEventListener('click', () => sort(head));
  for (const box of document.querySelectorAll('.filter')) {
    const rows = Array.from(box.parentNode.querySelectorAll('tbody tr'));
    const texts = rows.map((row) => Array.from(row.cells, (cell) => cell.textContent).join(' ').toLowerCase());
    const field = box.querySelector('input');
    const count = box.querySelector('output');
    field.addEventListener('input', () => filter_rows(rows, texts, field, count));
    box.hidden = false;
  }
  for (const map of document.querySelectorAll('.map'))
    for (const button of map.querySelectorAll('td button')) button.addEventListener('click', () => choose(map, button));
  for (const button of document.querySelectorAll('.command button')) {
    button.addEventListener('click', () => copy(button.previousElementSibling.textContent, button));
    button.hidden = false;
  }
})();
)js";

}  // namespace fascia::app
