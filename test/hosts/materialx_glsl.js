// Draws a sphere seen from far away by the pixel shader that MaterialX generated, and returns, for each light of irradiance 1 in
// `directions`, float32 RGBA of the picture in base64, the lowest row first. The vertex shader covers the picture.
function draw_sphere(surface, uniforms, directions, size) {
  const gl = Object.assign(document.createElement("canvas"), { width: size, height: size }).getContext("webgl2");
  gl.getExtension("EXT_color_buffer_float");
  const compiled = (kind, text) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  };
  const program = gl.createProgram();
  gl.attachShader(program, compiled(gl.VERTEX_SHADER, `#version 300 es
    void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }`));
  gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, surface + `
void main() {
    vec2 p = 2.0 * gl_FragCoord.xy / ${size}.0 - 1.0;
    normalWorld = vec3(p, sqrt(max(1.0 - dot(p, p), 1e-6)));
    tangentWorld = normalize(vec3(normalWorld.z, 0.0, -normalWorld.x));
    positionWorld = normalWorld;
    surface_main();
}`));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const location = (name) => gl.getUniformLocation(program, name);
  const setters = { color3: "uniform3fv", float: "uniform1f", boolean: "uniform1i", integer: "uniform1i" };
  for (const [name, [kind, value]] of Object.entries(uniforms)) gl[setters[kind]](location(name), value);
  gl.uniform3f(location("u_viewPosition"), 0, 0, 1e5);
  gl.uniform1i(location("u_numActiveLightSources"), 1);
  gl.uniform1i(location("u_lightData[0].type"), 1);
  gl.uniform3f(location("u_lightData[0].color"), 1, 1, 1);
  gl.uniform1f(location("u_lightData[0].intensity"), 1);
  const target = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, target);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, size, size);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
  gl.viewport(0, 0, size, size);
  return directions.map((direction) => {
    gl.uniform3fv(location("u_lightData[0].direction"), direction.map((x) => -x));
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const pixels = new Float32Array(4 * size * size);
    gl.readPixels(0, 0, size, size, gl.RGBA, gl.FLOAT, pixels);
    let text = "";
    for (const byte of new Uint8Array(pixels.buffer)) text += String.fromCharCode(byte);
    return btoa(text);
  });
}
