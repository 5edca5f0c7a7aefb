// Opens the pages in `out/` as a user does, from the file and without network, and checks what is on them.

import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const FRAMES_PER_SECOND = Number(process.env.LEAST_FRAMES_PER_SECOND ?? 30);
const BYTES = 3e6;
// Poses of a page are f32: relative to a coordinate, and rad.
const POSITION = 2.4e-7;
const ATTITUDE = 2e-7;

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--no-sandbox", "--no-first-run", "--disable-quic", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--disable-gpu", "--enable-unsafe-swiftshader",
  ],
});

/** The rows of a CSV, as objects of numbers. */
function table(name) {
  const [head, ...rows] = readFileSync(`out/${name}.csv`, "utf8").trim().split("\n").map((line) => line.split(","));
  return rows.map((row) => Object.fromEntries(row.map((field, column) => [head[column], Number(field)])));
}

/** Opens a page where no network is; whatever it asks for but itself, and every error, fails the test. */
async function opened(name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1360, height: 820 }, ...options });
  await context.setOffline(true);
  const page = await context.newPage();
  const url = pathToFileURL(`out/${name}.html`).href;
  page.on("request", (request) => assert.equal(request.url(), url, "the page asks for something else"));
  page.on("pageerror", (error) => assert.fail(error));
  page.on("console", (message) => assert.notEqual(message.type(), "error", message.text()));
  await page.goto(url);
  await page.waitForFunction(() => window.hamel);
  return page;
}

const timeOf = (page) => page.evaluate(() => hamel.time);

/** Angle of the rotation between two unit quaternions. */
function angleBetween(p, q) {
  const sum = (sign) => Math.hypot(...p.map((part, k) => part + sign * q[k]));
  return 4 * Math.asin(Math.min(1, Math.min(sum(1), sum(-1)) / 2));
}

/** Compares poses that the page shows with the CSV, at frames spread over the motion. */
async function checkPoses(page, name) {
  const rows = new Map(table(name).map((row) => [row.t_s, row]));
  const times = await page.evaluate(() => Array.from(hamel.recording.times));
  const bodies = await page.evaluate(() => hamel.recording.bodies.map((body) => body.name));
  let [position, attitude] = [0, 0];
  for (let k = 0; k <= 20; k++) {
    const time = times[Math.round((k * (times.length - 1)) / 20)];
    const row = rows.get(time);
    assert.ok(row, `the frame at ${time} s is no sample`);
    const shown = await page.evaluate((time) => {
      hamel.seek(time);
      return new Promise((resolve) =>
        requestAnimationFrame(() => resolve(hamel.recording.bodies.map((body) => hamel.body(body.name)))),
      );
    }, time);
    bodies.forEach((body, index) => {
      const wanted = (ends) => ends.map((end) => row[`${body}.${end}`]);
      const place = wanted(["x_m", "y_m", "z_m"]);
      const size = Math.max(1, ...place.map(Math.abs));
      const off = Math.max(...place.map((part, axis) => Math.abs(part - shown[index].com[axis])));
      position = Math.max(position, off / size);
      attitude = Math.max(attitude, angleBetween(shown[index].quaternion, wanted(["qx", "qy", "qz", "qw"])));
    });
  }
  assert.ok(position <= POSITION, `${name}: positions differ from the CSV by ${position}`);
  assert.ok(attitude <= ATTITUDE, `${name}: attitudes differ from the CSV by ${attitude} rad`);
  console.log(`${name}: poses as in the CSV, to ${position.toExponential(1)} and ${attitude.toExponential(1)} rad`);
}

/** Play moves the bodies, fast enough; Pause stops them. */
async function checkPlay(page, name) {
  await page.evaluate(() => hamel.seek(0));
  const before = await page.locator("#view").screenshot();
  await page.click("#play");
  // Until the page has found how sharp a picture this machine can draw.
  await page.waitForTimeout(4000);
  const drawn = await page.evaluate(() => {
    const start = performance.now();
    let count = 0;
    return new Promise((resolve) => {
      const next = () => {
        const span = performance.now() - start;
        if (span > 4000) resolve((1000 * count) / span);
        else requestAnimationFrame(next);
        count += 1;
      };
      next();
    });
  });
  const told = await page.locator("#rate").textContent();
  await page.click("#play");
  const time = await timeOf(page);
  await page.waitForTimeout(200);
  assert.ok(time > 0, "play does not move the time");
  assert.equal(await timeOf(page), time, "pause does not stop");
  assert.notDeepEqual(await page.locator("#view").screenshot(), before, "nothing moved");
  console.log(`${name}: ${drawn.toFixed(1)} frames/s (the page says ${told})`);
  assert.ok(drawn >= FRAMES_PER_SECOND, `${drawn} frames/s, and the least is ${FRAMES_PER_SECOND}`);
}

/** Whether something holds within a second: what is drawn follows in the next frame, and a page that has just scrolled is laid out anew. */
async function comesTrue(holds) {
  for (let k = 0; k < 20; k++) {
    if (await holds()) return true;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  return false;
}

/** The slider, the plots and the keys move the time. */
async function checkScrubbing(page) {
  const duration = await page.evaluate(() => hamel.recording.duration);
  await page.locator("#scrub").fill("0.25");
  assert.ok(Math.abs((await timeOf(page)) - 0.25 * duration) < 1e-9);
  for (const [chart, part] of [[0, 0.7], [1, 0.4], [3, 0.9]]) {
    const plot = page.locator(".plot").nth(chart);
    await plot.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await plot.boundingBox();
    // The margins of a plot are 50 and 8 pixels.
    await page.mouse.click(x + 50 + part * (width - 58), y + height / 2);
    assert.ok(Math.abs((await timeOf(page)) - part * duration) < duration / 100, `plot ${chart} does not scrub`);
    const isThere = async () => {
      const [cursor, box] = [await plot.locator(".cursor").boundingBox(), await plot.boundingBox()];
      return Math.abs(cursor.x - box.x - 50 - part * (box.width - 58)) < 2;
    };
    assert.ok(await comesTrue(isThere), "the cursor is elsewhere");
  }
  await page.locator("#stage").focus();
  await page.keyboard.press("Home");
  await page.keyboard.press("ArrowRight");
  const second = await page.evaluate(() => hamel.recording.times[1]);
  assert.equal(await timeOf(page), second);
  const legend = await page.locator(".chart").first().locator(".legend").textContent();
  assert.match(legend, /kinetic .*potential .*total /);
}

/** Keys do the same after a click on any control. */
async function checkKeys(page) {
  for (const id of ["rods", "rods", "follow", "follow", "loop", "loop", "all", "home", "scrub"]) {
    await page.click(`#${id}`);
    await page.keyboard.press("Home");
    await page.keyboard.press("ArrowRight");
    assert.equal(await timeOf(page), await page.evaluate(() => hamel.recording.times[1]), `an arrow after a click on ${id}`);
    for (const playing of [true, false]) {
      await page.keyboard.press(" ");
      assert.equal(await page.evaluate(() => hamel.playing), playing, `Space after a click on ${id}`);
    }
  }
  await page.keyboard.press("a");
  assert.equal(await page.isChecked("#follow"), false, "all of the motion, and follows");
  await page.keyboard.press("f");
  assert.equal(await page.isChecked("#follow"), true, "F does not follow");
  await page.keyboard.press("r");
}

/** A click selects a body; its panel has the numbers of the CSV; drags and the wheel move the view. */
async function checkView(page, name) {
  const { x, y, width, height } = await page.locator("#stage").boundingBox();
  let selected = false;
  for (let k = 0; k < 400 && !selected; k++) {
    await page.mouse.click(x + width * (0.3 + 0.02 * (k % 20)), y + height * (0.3 + 0.025 * Math.floor(k / 20)));
    selected = await page.locator("#selected").isVisible();
  }
  assert.ok(selected, "no click in the picture selects a body");
  const body = await page.locator("#selected h2").textContent();
  const frame = await page.evaluate(() => hamel.recording.frames >> 1);
  const time = await page.evaluate((frame) => (hamel.seek(hamel.recording.times[frame]), hamel.time), frame);
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  const row = table(name).find((row) => row.t_s === time);
  const shown = (await page.locator("#selected dd").first().textContent()).trim().split(/\s+/);
  shown.forEach((text, axis) => {
    const wanted = row[`${body}.${["x_m", "y_m", "z_m"][axis]}`];
    assert.ok(Math.abs(Number(text.replace("−", "-")) - wanted) <= 1e-4, `${body}: ${text} instead of ${wanted}`);
  });
  const picture = () => page.locator("#stage").screenshot();
  const pictures = [await picture()];
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 + 120, y + height / 2 - 40, { steps: 4 });
  await page.mouse.up();
  pictures.push(await picture());
  await page.mouse.wheel(0, -400);
  await page.waitForTimeout(200);
  pictures.push(await picture());
  for (const option of ["frames", "trails", "rods", "ground"]) {
    await page.locator(`#${option}`).click();
    await page.waitForTimeout(100);
    pictures.push(await picture());
  }
  for (let k = 1; k < pictures.length; k++)
    assert.notDeepEqual(pictures[k], pictures[k - 1], `view ${k} looks like the one before`);
  for (const option of ["frames", "trails", "rods", "ground"]) await page.locator(`#${option}`).click();
  await page.keyboard.press("Escape");
  await page.click("#home");
}

/** Two fingers change how near the bodies are. */
async function checkTouch(name) {
  const page = await opened(name, { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true });
  const { x, y, width, height } = await page.locator("#stage").boundingBox();
  const client = await page.context().newCDPSession(page);
  const touch = (type, spread) =>
    client.send("Input.dispatchTouchEvent", {
      type,
      touchPoints: type === "touchEnd" ? [] : [-1, 1].map((side, id) => ({ x: x + width / 2 + side * spread, y: y + height / 2, id })),
    });
  const before = await page.locator("#stage").screenshot();
  await touch("touchStart", 30);
  for (const spread of [50, 70, 90]) await touch("touchMove", spread);
  await touch("touchEnd");
  await page.waitForTimeout(200);
  assert.notDeepEqual(await page.locator("#stage").screenshot(), before, "fingers do not zoom");
  await page.screenshot({ path: `out/${name}_phone.png` });
  await page.context().close();
}

const bytes = statSync("out/g1.html").size;
console.log(`g1: ${bytes} bytes for 10 s`);
assert.ok(bytes < BYTES);

for (const name of ["g1", "plate_cart_arm", "snakeboard"]) {
  const page = await opened(name);
  await checkPoses(page, name);
  await checkScrubbing(page);
  await checkKeys(page);
  await checkView(page, name);
  await checkPlay(page, name);
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme });
    await page.evaluate(() => hamel.seek(0.37 * hamel.recording.duration));
    await page.waitForTimeout(200);
    await page.screenshot({ path: `out/${name}_${colorScheme}.png` });
  }
  await page.context().close();
}
await checkTouch("plate_cart_arm");
await browser.close();
console.log("all is well");
