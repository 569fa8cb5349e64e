// What the colours of a picture mean: a ramp with its ticks, and classes with their counts.

/** The ramp with its ticks, and what it is of. */
function rampBar(ticks, text) {
    const bar = make("canvas", { width: 256, height: 12, className: "bar", "aria-hidden": "true" }),
          context = bar.getContext("2d");
    ramp.forEach((c, i) => {
        context.fillStyle = `rgb(${c.join(",")})`;
        context.fillRect(i, 0, 1, 12);
    });
    const scale = make("span", { className: "scale" }, bar);
    for (const [position, label] of ticks) {
        const tick = make("span", { className: "tick" }, label);
        tick.style.left = `${position * 256}px`;
        scale.append(tick);
    }
    return make("span", { className: "ramp" }, scale, make("span", { className: "unit" }, text));
}

/** An operation's expression, or a word of ours. */
const categoryName = (metric, value) =>
    (metric.blamed ? metric.categories[value][0] : words(metric.categories[value][0]));

/** The operations that are to blame most often, and in how many pixels. */
function culpritLegend(metric, pixels) {
    const counts = new Map(), most = 8;
    for (const c of pixels.stored[metric.name])
        if (!Number.isNaN(c)) counts.set(c, (counts.get(c) ?? 0) + 1);
    const order = [...counts].sort((a, b) => b[1] - a[1] || a[0] - b[0]),
          rest = order.slice(most).reduce((sum, [, n]) => sum + n, 0);
    const shown = order.slice(0, most).map(
        ([c, n]) =>
            make("span", { className: "class" }, swatch(metric.categories[c][1]), ` ${metric.categories[c][0]} ${n}`));
    return rest > 0 ?
        [
            ...shown,
            make("span", { className: "class" }, `${order.length - most} more, each in its own colour ${rest}`)
        ] :
        shown;
}

async function drawLegend() {
    const metric = metricNow(), row = rowNow(), children = [];
    if (metric.scales)
        children.push(rampBar(
            scaleOf(metric, row).ticks,
            `${words(metric.name)}${
                metric.unit && metric.unit !== "1" && !metric.name.includes(metric.unit) ? `, ${metric.unit}` : ""}`));
    if (metric.blamed) children.push(...culpritLegend(metric, await pixelsOf(mapNow(), row)));
    else if (metric.categories) {
        for (const [name, colour] of metric.categories)
            children.push(make("span", { className: "class" }, swatch(colour), ` ${words(name)}`));
    }
    if (metricNow() !== metric || rowNow() !== row) return;  // another is looked at by now
    if (!metric.marches && !metric.every_ray) {
        const wrongOnes = ["false_hit", "false_miss", "wrong_object", "crack", "double_hit", "out_of_order"].map(
            (name) => outcomeNames.indexOf(name));  // a culprit is named for those too
        index.outcomes.forEach(([name, colour], o) => {
            if (metric.blamed && wrongOnes.includes(o)) return;
            if (row.outcomes[o] > 0 && (o !== agreeHit || metric.kind === "classes"))
                children.push(
                    make("span", { className: "class" }, swatch(colour), ` ${words(name)} ${row.outcomes[o]}`));
        });
    }
    mapParts.legend.replaceChildren(...children);
}
