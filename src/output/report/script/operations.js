// The operations of the rays that the page holds, as `lostbits explain` lists them, and the links to these rays.

/** The rays of a row whose operations the page holds, the worst first; none for a compiled form. */
const raysOf = (map, row) => (row.formula ? jsonOf(`rays:${map.id}:${keyOf(row)}`) : Promise.resolve([]));

const isAt = (x, y) => (ray) => ray.x === x && ray.y === y;
const reasons = (ray) => ray.why.map(words).join(", ");

/** The held ray nearest to a pixel, and its distance in pixels. */
function nearestRay(rays, x, y) {
    const away = (ray) => Math.hypot(ray.x - x, ray.y - y), ray = rays.reduce((a, b) => (away(b) < away(a) ? b : a));
    return { ray, pixels: away(ray) };
}

/** Goes to the next held ray, or to the first if the chosen pixel has no held ray. */
async function cycleRay(by) {
    const rays = await raysOf(mapNow(), rowNow()), at = rays.findIndex(isAt(state.x, state.y));
    if (rays.length === 0) return;
    await goToPixel(rays[at < 0 ? 0 : (at + by + rays.length) % rays.length]);
}

/** A picker with the held rays. The ray whose operations are shown is chosen. */
function rayPicker(rays, x, y) {
    const named = rays.map((ray, k) => [String(k), `${ray.x}, ${ray.y}: ${reasons(ray)}`]),
          at = rays.findIndex(isAt(x, y));
    const choose = (k) => k !== "" && goToPixel(rays[Number(k)]);
    return make(
        "div.rays",
        choice(
            "rays whose operations this page holds", "pick-ray", [["", "choose one"], ...named],
            at < 0 ? "" : String(at), choose));
}

/** Makes a row of the table. `values` has the order of `operation_json` (ray_data.cpp). */
function operationRow(values) {
    const [node, name, formula, computed, exact, digits, error, cancelled, local, rounding, share, isCulprit, isFlipped] =
        values;
    const shown = (x) => {
        if (digits === 0) return String(x);
        const value = asNumber(x);
        return decimal(Number.isFinite(value) ? Number(value.toPrecision(digits)) : value);
    };
    const line = cells("td", name, formula, shown(computed), shown(exact), error, cancelled, local, rounding, share);
    line.children[1].className = "expression";
    if (digits !== 0) {
        line.children[2].title = hex(asNumber(computed));
        line.children[3].title = decimal(asNumber(exact));
    }
    line.dataset.node = node;
    if (isCulprit) line.className = "culprit";
    if (isFlipped) line.children[1].append(make("em", " rounding chose the other side"));
    return line;
}

function operationTable(row, ray) {
    const of = ray.primitive === undefined ? "" : `, primitive ${ray.primitive}`;
    const earlier = ray.earlier > 0 ? ` ${ray.earlier} operations of earlier samples are left out.` : "";
    return [
        make("h3", `Operation by operation: ${title(row)}${of}, pixel ${ray.x}, ${ray.y} (${reasons(ray)})`),
        ...ray.says.map((sentence) => make("p.sentence", sentence)),
        make("p.hint.sideways", "The table continues to the right: scroll it sideways."),
        make(
            "div.scrolls", { tabIndex: 0, role: "region", "aria-label": "operations, scrolled sideways" },
            make(
                "table.operations", make("caption", `The ray of pixel ${ray.x}, ${ray.y}`),
                header(
                    "operation", "computed from", "computed", "without rounding", "error, ulp", "bits cancelled",
                    "local bits", "own error, ulp", `share of ${ray.subject}, ulp`),
                make("tbody", ...ray.rows.map(operationRow)))),
        ...ray.sums.map((sentence) => make("p.sentence", sentence)),
        make(
            "p.hint",
            "own error: the operation's rounding error, in ulps of its own result. " +
                `share of ${ray.subject}: how much of the error of ${ray.subject} comes from that rounding. ` +
                "local: bits that the operation alone would lose on exact operands. " +
                `Only inexact operations that lead to the answer are shown.${earlier}`)
    ];
}

/** Text for a pixel whose operations the page does not hold: the command that shows them, and the nearest held ray. */
function missingOperations(map, row, rays, x, y) {
    const { explain } = commandsFor(map, row, x, y, metricNow());
    const says = row.formula ? " shows the operations of this ray." : " names forms that do better.";
    const parts = [
        row.formula ? `The page does not hold the operations of pixel ${x}, ${y}. ` :
                      "Its operations are not known, because a compiled function is a black box. ",
        make("code", explain), says, " ", ...copyButtons(mapParts.copied, ["copy-elsewhere", "copy it", () => explain])
    ];
    if (rays.length > 0) {
        const { ray, pixels } = nearestRay(rays, x, y);
        parts.push(
            ` The nearest ray whose operations it holds is ${rounded(pixels)} pixel${pixels === 1 ? "" : "s"} away: `,
            button("#nearest-ray", () => goToPixel(ray), `pixel ${ray.x}, ${ray.y} (${reasons(ray)})`));
    }
    return hint(...parts);
}

let operationsAsked = 0;

/** Shows the operations of the ray of a pixel, or the way to find them; x < 0: no pixel is chosen. */
async function showOperations(element, map, row, x, y) {
    const number = ++operationsAsked, rays = await raysOf(map, row);
    if (number !== operationsAsked) return;  // another pixel has been asked for since
    const ray = rays.find(isAt(x, y)), focusedId = document.activeElement?.id;
    element.replaceChildren(
        ...(rays.length > 0 ? [rayPicker(rays, x, y)] : []),
        ...(ray       ? operationTable(row, ray) :
                x < 0 ? [] :
                        [missingOperations(map, row, rays, x, y)]));
    if (focusedId === "pick-ray" || (focusedId === "nearest-ray" && ray)) document.getElementById("pick-ray")?.focus();
    if (x < 0) delete element.dataset.pixel;
    else element.dataset.pixel = `${x},${y}`;
}
