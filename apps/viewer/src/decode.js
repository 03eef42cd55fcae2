// Numbers from the base64 texts of the page; all little-endian.

function bytes(text) {
  const letters = atob(text ?? '');
  const result = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; ++i) result[i] = letters.charCodeAt(i);
  return result.buffer;
}

export const int16 = (text) => new Int16Array(bytes(text));
export const float32 = (text) => new Float32Array(bytes(text));
export const uint32 = (text) => new Uint32Array(bytes(text));

// {offset_m, step_m, int16} to x y z x y z ... [m].
export function points(quantised) {
  const steps = int16(quantised.int16);
  const result = new Float32Array(steps.length);
  for (let i = 0; i < steps.length; ++i) result[i] = quantised.offset_m[i % 3] + quantised.step_m * steps[i];
  return result;
}
