"use strict";
// A click on a heading sorts the table by that column, a second click the other way round; empty cells stay last.
const order = new Intl.Collator(undefined, { numeric: true });
for (const heading of document.querySelectorAll("th")) {
  heading.querySelector("button").addEventListener("click", () => {
    const table = heading.closest("table"), body = table.tBodies[0], column = heading.cellIndex;
    const sign = heading.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    const numeric = !heading.classList.contains("text");
    const rows = Array.from(body.rows, (row) => ({ row, cell: row.cells[column].textContent }));
    rows.sort((a, b) => {
      if (a.cell === "" || b.cell === "") return (a.cell === "") - (b.cell === "");
      return sign * (numeric ? Number(a.cell) - Number(b.cell) : order.compare(a.cell, b.cell));
    });
    body.append(...rows.map((entry) => entry.row));
    for (const other of table.querySelectorAll("th")) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
  });
}
