// A button beside each table of the report that saves it as CSV; tables wider than the page are drawn closer, or stacked, row below row.
// A text that a spreadsheet would compute stands behind an apostrophe; axes, numbers and per cent are none.
const harmless = /^(?:[+-][xyz]|[+-]?\d[\d.,]*(?:e[+-]?\d+)?(?: %)?|[^=+\-@].*|)$/s;
// Spreadsheets take a typographic minus sign for a letter.
const minusSign = /^\u2212(?=[xyz]$|\d)|(?<=^[\u2212\d.,]+e)\u2212(?=\d)/g;
const plain = (text) => {
  const typed = text.replace(minusSign, "-");
  return harmless.test(typed) ? typed : `'${typed}`;
};
const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

document.querySelectorAll(".scroll > table").forEach((table, number) => {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "csv";
  button.textContent = "CSV";
  const title = table.closest("section")?.querySelector("h2")?.textContent ?? "table";
  button.setAttribute("aria-label", `Save the table “${title}” as CSV`);
  button.addEventListener("click", () => {
    const lines = [...table.rows].map((row) => [...row.cells].map((cell) => quoted(plain(cell.innerText.trim().replace(/\s+/g, " ")))).join(","));
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob(["\ufeff" + lines.join("\r\n") + "\r\n"], { type: "text/csv" }));
    link.download = `${document.querySelector("h1").textContent} ${title} ${number + 1}.csv`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  });
  table.parentElement.before(button);
  const headings = [...(table.tHead?.rows[0]?.cells ?? [])].map((cell) => cell.textContent.trim());
  for (const row of table.tBodies[0].rows) [...row.cells].forEach((cell, place) => (cell.dataset.heading = headings[place] ?? ""));
});

function stack() {
  for (const box of document.querySelectorAll(".scroll:has(> table)")) {
    const wide = () => box.scrollWidth > box.clientWidth + 1;
    box.classList.remove("tight", "stacked");
    if (wide()) box.classList.add("tight");
    if (wide()) box.classList.add("stacked");
  }
}
stack();
addEventListener("resize", stack);
// A table that was hidden had no width.
addEventListener("toggle", stack, true);
// Paper cannot be clicked.
addEventListener("beforeprint", () => document.querySelectorAll("details.whole").forEach((whole) => (whole.open = true)));
