// What is known of one pixel, in words and exact numbers.

const title = (row) => `${row.form} in ${row.format}`;

/** `t`, the truth and the metrics of a pixel under a form in each of its formats. */
async function pixelFacts(map, row, x, y) {
    const i = y * map.width + x;
    const same = map.rows.filter((r) => r.form === row.form);
    const all = await Promise.all(same.map((r) => pixelsOf(map, r)));
    const pixels = all[same.indexOf(row)], { truth } = pixels;
    const answers = same.map((r, k) => {
        const p = all[k], hit = p.object[i] > 0, agreed = p.outcome[i] === agreeHit, s = sampleAt(p, i);
        return {
            format: r.format,
            outcome: outcomeNames[p.outcome[i]],
            hit,
            t: p.t[i],
            object: p.object[i] - 1,
            ulp_error: agreed ? derived.ulp_error(s) : NaN,
            lost_bits: agreed ? derived.lost_bits(s) : NaN,
        };
    });
    const metrics =
        map.metrics.map((m) => [m, valueAt(pixels, m, i)]).filter(([m]) => !m.marches || row.form.startsWith("sdf."));
    return {
        outcome: outcomeNames[pixels.outcome[i]],
        decision: ["miss", "hit", "unresolved"][truth.decision[i]],
        truth: truth.truth[i],
        rest: truth.rest[i],
        bound: truth.bound[i],
        trueObject: truth.object[i] - 1,
        answers,
        metrics,
    };
}

const tidy = (x) => (Number.isFinite(x) ? decimal(Number(x.toPrecision(7))) : decimal(x));

function cells(tag, ...texts) {
    return make(
        "tr", {},
        ...texts.map((text, k) => make(k === 0 ? "th" : tag, k === 0 ? { scope: "row" } : { className: "n" }, text)));
}

function header(...texts) {
    return make("thead", {}, make("tr", {}, ...texts.map((text) => make("th", { scope: "col" }, text))));
}

function truthText(facts, row) {
    if (facts.decision !== "hit")
        return [
            facts.decision === "miss" ? "The ray truly misses." :
                                        "The true answer could not be proved, so this ray is not counted."
        ];
    const bound = facts.bound === -32768 ? "exactly" : `within 2^${facts.bound}`;
    const rest = facts.rest === 0 ? "" : ` ${facts.rest < 0 ? "-" : "+"} ${tidy(Math.abs(facts.rest))}`;
    return [
        make("b", {}, row.direction === "unit" ? "true distance " : "true t "),
        make("code", { data: { truth: decimal(facts.truth) } }, decimal(facts.truth)), `${rest}, ${bound}; `,
        make("code", {}, hex(facts.truth)), `; solid ${facts.trueObject}`
    ];
}

function answerTable(facts) {
    const body = make("tbody");
    for (const a of facts.answers) {
        body.append(cells(
            "td", a.format, a.hit ? decimal(a.t) : "no hit", a.hit ? hex(a.t) : "",
            Number.isNaN(a.ulp_error) ? words(a.outcome) : tidy(a.ulp_error),
            Number.isNaN(a.lost_bits) ? "" : a.lost_bits.toFixed(2)));
        body.lastChild.dataset.format = a.format;
    }
    return make("table", { className: "answers" }, header("format", "t", "t exactly", "ulp error", "lost bits"), body);
}

function metricTable(facts) {
    const body = make("tbody");
    for (const [m, value] of facts.metrics) {
        const text = Number.isNaN(value) ? "–" :
            m.categories                 ? categoryName(m, value) :
                                           `${tidy(value)} ${m.unit === "1" ? "" : m.unit}`;
        body.append(cells("td", words(m.name), text));
        body.lastChild.title = m.meaning;
        body.lastChild.dataset.metric = m.name;
    }
    return make("table", { className: "metrics" }, body);
}

/** What to type for the same map, and for one ray of it. */
function commandsFor(map, row, x, y, metric) {
    const drawn = metric.kind === "classes" ? "" : ` --metric ${metric.name}`;
    return {
        map: `lostbits map ${map.named} -i ${row.form} -f ${row.format}${row.from}${drawn} --pixels csv -o out`,
        explain: `lostbits explain ${map.named} --pixel ${x},${y} -i ${row.form} -f ${row.format}${row.from}`,
    };
}

/**
 * Room about a measured number, so that a claim does not fail over nothing: half a bit, a hundredth of a share, a
 * hundredth of the rays, and else a tenth. Nothing below 0; of an exact zero, only zero.
 */
function intervalAbout(column, value, rays) {
    if (outcomeNames.includes(column)) {
        const by = Math.max(1, Math.ceil(rays / 100));
        return [Math.max(0, value - by), Math.min(rays, value + by)];
    }
    const isShare = column.endsWith("_fraction"),
          by = column.includes("bits") ? 0.5 :
        isShare                        ? 0.01 :
                                         Math.abs(value) / 10;
    const digits = (x) => Number(x.toPrecision(3)), low = Math.max(0, value - by), high = value + by;
    // Outwards: three digits may lie a two-hundredth inside, which a tenth covers; bits and shares are cut apart.
    return column.includes("bits") ? [Math.floor(low * 10) / 10, Math.ceil(high * 10) / 10] :
        isShare                    ? [Math.floor(low * 1000) / 1000, Math.min(1, Math.ceil(high * 1000) / 1000)] :
                                     [digits(low), digits(high)];
}

/** `in = […]`, and what was measured. */
function intervalLine(column, value, rays, isDrawn = false) {
    const [low, high] = intervalAbout(column, value, rays);
    const advice = isDrawn ?
        "; the rays are random, so take the interval that `lostbits check --measure --seeds 31` prints" :
        "; make the interval as wide as the sentence allows";
    return `# measured ${decimal(value)}${advice}\nin = [${decimal(low)}, ${decimal(high)}]`;
}

/** A claim of what the summary has for this row, two-sided, ready for data/claims. */
function claimFor(map, row, metric) {
    const rays = row.outcomes.reduce((a, b) => a + b, 0);
    const statistic = row.statistics[metric.name];
    const quantile = typeof statistic?.[1] === "number" && isEnough(row.outcomes[agreeHit], row.true_hits);
    const [column, value] = quantile ? [`${metric.name}_p99`, statistic[1]] : ["agree_hit", row.outcomes[agreeHit]];
    return `[[claim]]
id = "my.${map.id}.${row.form}.${row.format}.${column}"
statement = "Say in one sentence what should hold"
source = "-"
verdict = "holds"
note = "${column} over ${rays} rays, from the report"
[claim.given]
scene = "${map.id}"
form = "${row.form}"
format = "${row.format}"
[claim.expect]
metric = "${column}"
${intervalLine(column, value, rays)}
`;
}

let asked = 0;

async function showPixel(element, map, row, x, y, pinned) {
    const number = ++asked;
    const facts = await pixelFacts(map, row, x, y),
          other = otherRow() ? [await otherAnswer(map, otherRow(), x, y)] : [];
    if (number !== asked) return;  // another pixel has been asked for since
    element.replaceChildren(
        make("h3", {}, `Pixel ${x}, ${y}${pinned ? "" : " (under the pointer)"}`),
        make(
            "p", { className: "outcome" }, swatch(index.outcomes[outcomeNames.indexOf(facts.outcome)][1]),
            ` ${letterA()}${words(facts.outcome)}: ${title(row)}`),
        ...other, make("p", {}, ...truthText(facts, row)), answerTable(facts), metricTable(facts));
    element.dataset.pixel = `${x},${y}`;
}

/** A small square of a class's colour. */
function swatch(colour) {
    const canvas = make("canvas", { width: 12, height: 12, className: "swatch", "aria-hidden": "true" });
    const context = canvas.getContext("2d");
    context.fillStyle = `rgb(${colour.join(",")})`;
    context.fillRect(0, 0, 12, 12);
    return canvas;
}
