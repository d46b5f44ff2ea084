// Strokes on a canvas, in pixels of the style sheet.

/** The canvas cleared, in the size in which it is shown, with units of the style sheet. */
export function sized(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  return { context, ratio, width: canvas.clientWidth, height: canvas.clientHeight };
}

export function line(context, from, to, style, width, dash) {
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.setLineDash(dash || []);
  context.strokeStyle = style;
  context.lineWidth = width;
  context.stroke();
  context.setLineDash([]);
}

export function ring(context, x, y, radius, style, width) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.strokeStyle = style;
  context.lineWidth = width;
  context.stroke();
}

export function disc(context, x, y, radius, style) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = style;
  context.fill();
}

export function cross(context, x, y, size, style, width) {
  line(context, [x - size, y - size], [x + size, y + size], style, width);
  line(context, [x - size, y + size], [x + size, y - size], style, width);
}

export function label(context, text, x, y, style, halo, size = 12) {
  context.font = `600 ${size}px system-ui, 'DejaVu Sans', sans-serif`;
  context.textAlign = "center";
  context.lineJoin = "round";
  context.lineWidth = 3.5;
  context.strokeStyle = halo;
  context.strokeText(text, x, y);
  context.fillStyle = style;
  context.fillText(text, x, y);
}

/** A canvas of the same size over this one. */
export function blit(context, canvas, alpha) {
  context.save();
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.globalAlpha = alpha;
  context.drawImage(canvas, 0, 0);
  context.restore();
}

/** A picture whose pixels the matrix [a, b, c, d, e, f] takes to m in the world. */
export function drawPicture(context, camera, { canvas, matrix }, ratio) {
  const scale = camera.scale * ratio, [e, f] = camera.toScreen(matrix[4], matrix[5]);
  context.save();
  context.setTransform(
    matrix[0] * scale, -matrix[1] * scale, matrix[2] * scale, -matrix[3] * scale, e * ratio, f * ratio,
  );
  context.imageSmoothingEnabled = Math.hypot(matrix[0], matrix[1]) * camera.scale <= 3;
  context.drawImage(canvas, 0, 0);
  context.restore();
}
