// The inspector: all that the page holds about one pixel, in words and exact numbers.

const title = (row) => `${row.form} in ${row.format}`;

/** The answer `t` of a form in each of its formats, the truth, and the metrics at a pixel. */
async function pixelFacts(map, row, x, y) {
    const i = y * map.width + x, same = map.rows.filter((r) => r.form === row.form);
    const all = await Promise.all(same.map((r) => pixelsOf(map, r))), pixels = all[same.indexOf(row)],
          { truth } = pixels;
    return {
        outcome: pixels.outcome[i],
        truth: Object.fromEntries(Object.entries(truth).map(([name, values]) => [name, values[i]])),
        answers: all.map((p) => {
            const agreed = p.outcome[i] === agreeHit,
                  metricOf = (name) => (agreed ? derived[name](sampleAt(p, i)) : NaN);
            return {
                ...{ format: p.row.format, outcome: p.outcome[i], hit: p.object[i] > 0, t: p.t[i] },
                ...{ ulp_error: metricOf("ulp_error"), lost_bits: metricOf("lost_bits") }
            };
        }),
        metrics: map.metrics.filter((m) => !m.marches || marches(row.form)).map((m) => [m, valueAt(pixels, m, i)])
    };
}

const tidy = (x) => (Number.isFinite(x) ? decimal(Number(x.toPrecision(7))) : decimal(x));

function cells(tag, ...texts) {
    return make(
        "tr",
        ...texts.map((text, k) => make(k === 0 ? "th" : tag, k === 0 ? { scope: "row" } : { className: "n" }, text)));
}

function header(...texts) {
    return make("thead", make("tr", ...texts.map((text) => make("th", { scope: "col" }, text))));
}

function truthText({ decision, truth, rest, bound, object }, row) {
    if (decision === 0) return ["The ray truly misses."];
    if (decision === 2) return ["The true answer could not be proved, so the ray is not counted."];
    const off = rest === 0 ? "" : ` ${rest < 0 ? "-" : "+"} ${tidy(Math.abs(rest))}`;
    return [
        make("b", row.direction === "unit" ? "true distance " : "true t "),
        make("code", { data: { truth: decimal(truth) } }, decimal(truth)),
        `${off}, ${bound === -32768 ? "exactly" : `within 2^${bound}`}; `, make("code", hex(truth)),
        `; primitive ${object - 1}`
    ];
}

function answerTable(facts) {
    const body = make("tbody");
    for (const a of facts.answers) {
        body.append(cells(
            "td", a.format, a.hit ? decimal(a.t) : "no hit", a.hit ? hex(a.t) : "",
            Number.isNaN(a.ulp_error) ? words(outcomeNames[a.outcome]) : tidy(a.ulp_error),
            Number.isNaN(a.lost_bits) ? "" : a.lost_bits.toFixed(2)));
        body.lastChild.dataset.format = a.format;
    }
    return make("table.answers", header("format", "t", "t exactly", "ulp error", "lost bits"), body);
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
    return make("table.metrics", body);
}

/** Quotes a word for a shell if it needs quotes. */
function shellWord(word) { return /^[A-Za-z0-9_./,:+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`; }

/** Commands for the same map, and for one ray of it. */
function commandsFor(map, row, x, y, metric) {
    const drawn = metric.kind === "classes" ? "" : ` --metric ${shellWord(metric.name)}`;
    return {
        map: `lostbits map ${map.named} -i ${row.form} -f ${row.format}${row.from}${drawn} --pixels csv -o out`,
        explain: `lostbits explain ${map.named} --pixel ${x},${y} -i ${row.form} -f ${row.format}${row.from}`,
    };
}

/**
 * Interval about a measured number for a claim, so that a tiny change does not make it fail: half a bit, a hundredth
 * for a fraction, a hundredth of the rays for a count but at most a tenth of it, else a tenth of the value. It never
 * reaches below 0. An exact zero allows only zero. One ray allows only its outcome.
 */
function intervalAbout(column, value, rays) {
    if (outcomeNames.includes(column) && rays === 1) return [value, value];
    if (outcomeNames.includes(column)) {
        const by = Math.max(1, Math.ceil(Math.min(rays / 100, value / 10)));
        return [Math.max(0, value - by), Math.min(rays, value + by)];
    }
    const isShare = column.endsWith("_fraction"),
          by = column.includes("bits") ? 0.5 :
        isShare                        ? 0.01 :
                                         Math.abs(value) / 10;
    const digits = (x) => Number(x.toPrecision(3)), low = Math.max(0, value - by), high = value + by;
    // Round outwards. Three digits may lie a two-hundredth inside the interval, which the tenth covers; bits and
    // fractions are cut separately.
    return column.includes("bits") ? [Math.floor(low * 10) / 10, Math.ceil(high * 10) / 10] :
        isShare                    ? [Math.floor(low * 1000) / 1000, Math.min(1, Math.ceil(high * 1000) / 1000)] :
                                     [digits(low), digits(high)];
}

/** The line `in = […]` of a claim, and a comment with the measured number. */
function intervalLine(column, value, rays, isDrawn) {
    const [low, high] = intervalAbout(column, value, rays);
    const advice = isDrawn ?
        "; the rays are random, so take the interval that `lostbits check --measure --seeds 31` prints" :
        "; make the interval as wide as your statement allows";
    return `# measured ${decimal(value)}${advice}\nin = [${decimal(low)}, ${decimal(high)}]`;
}

/**
 * Text of a two-sided claim about a row of the page, ready for data/claims. `given` names the rays that it is measured
 * on. Every string of JSON is a string of TOML.
 */
function claimText(id, given, { form, format }, [column, value], rays, isDrawn) {
    return `# Paste below the line schema = "lostbits-claims/1" at the head of a claim file.
[[claim]]
id = ${JSON.stringify(`my.${id}.${form}.${format}.${column}`)}
statement = "Say in one sentence what should hold"
source = "-"
verdict = "holds"
note = ${JSON.stringify(`${column} over ${rays === 1 ? "one ray" : `${rays} rays`}, from the report`)}
[claim.given]
${given}
form = "${form}"
format = "${format}"
[claim.expect]
metric = ${JSON.stringify(column)}
${intervalLine(column, value, rays, isDrawn)}
`;
}

/**
 * Writes a claim. With a chosen ray: its metric if it has a value there, else its outcome. Without: the summary of the
 * whole map, which for the first metric is the number of the most frequent wrong decision, if there is one.
 */
async function claimFor(map, row, metric, x, y) {
    const scene = `scene = ${JSON.stringify(map.claimed)}`;
    if (x >= 0) {
        const pixels = await pixelsOf(map, row), i = y * map.width + x;
        const value = metric.kind === "classes" || metric.categories ? NaN : valueAt(pixels, metric, i);
        return claimText(
            `${map.id}.${x}-${y}`, `${scene}\npixel = [${x}, ${y}]`, row,
            Number.isFinite(value) ? [`${metric.name}_max`, Math.abs(value)] : [outcomeNames[pixels.outcome[i]], 1], 1);
    }
    const p99 = row.statistics[metric.name]?.[1], agreed = row.outcomes[agreeHit];
    const known = typeof p99 === "number" && isEnough(agreed, row.true_hits);
    const [wrong] = [...wrongDecisions].sort((a, b) => row.outcomes[b] - row.outcomes[a]);
    if (["lost_bits", "outcome"].includes(metric.name) && row.outcomes[wrong] > 0)
        return claimText(map.id, scene, row, [outcomeNames[wrong], row.outcomes[wrong]], total(row.outcomes));
    return claimText(
        map.id, scene, row, known ? [`${metric.name}_p99`, p99] : ["agree_hit", agreed], total(row.outcomes));
}

let asked = 0;

async function showPixel(element, map, row, x, y, pinned) {
    const number = ++asked;
    const facts = await pixelFacts(map, row, x, y),
          other = otherRow() ? [await otherAnswer(map, otherRow(), x, y)] : [];
    if (number !== asked) return;  // another pixel has been asked for since
    element.replaceChildren(
        make("h3", `Pixel ${x}, ${y}${pinned ? "" : " (under the pointer)"}`),
        make(
            "p.outcome", swatch(index.outcomes[facts.outcome][1]),
            ` ${letterA()}${words(outcomeNames[facts.outcome])}: ${title(row)}`),
        ...other, make("p", ...truthText(facts.truth, row)), answerTable(facts), metricTable(facts));
    element.dataset.pixel = `${x},${y}`;
}
