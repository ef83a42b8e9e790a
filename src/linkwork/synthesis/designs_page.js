// A click on a head sorts the table by its column, a second one the other way.
document.querySelectorAll("th button").forEach((button, column) => {
  let up = false;
  const key = (row) => row.cells[column].dataset.key ?? row.cells[column].textContent;
  button.addEventListener("click", () => {
    up = !up;
    const body = document.querySelector("tbody");
    const rows = [...body.rows].sort((a, b) => {
      const x = key(a), y = key(b), n = Number(x) - Number(y);
      return (Number.isNaN(n) ? x.localeCompare(y) : n) * (up ? 1 : -1);
    });
    body.append(...rows);
  });
});
