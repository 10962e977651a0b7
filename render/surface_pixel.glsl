// Position and normal of the visible surface at a pixel, input of pixel.glsl in a second pass.
in vec3 surface_position;
in vec3 surface_normal;
layout(location = 0) out vec4 position;
layout(location = 1) out vec4 normal;

void main() {
    position = vec4(surface_position, 1.0);
    normal = vec4(gl_FrontFacing ? surface_normal : -surface_normal, 0.0);
}
