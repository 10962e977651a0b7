# Draws the sphere and writes its picture: float32 of linear RGBA, the highest row first.
extends SceneTree

const SHADER = """
shader_type spatial;
render_mode ambient_light_disabled, specular_disabled;
CODE
mat3 frame_about(vec3 n) {  // v * frame_about(n) are the local coordinates of v
    vec3 t = normalize(abs(n.y) < 0.9 ? cross(vec3(0.0, 1.0, 0.0), n) : cross(vec3(1.0, 0.0, 0.0), n));
    return mat3(t, cross(n, t), n);
}
void fragment() {
    ALBEDO = vec3(1.0);
}
void light() {
    mat3 frame = frame_about(normalize(NORMAL));
    vec3 wl = normalize(LIGHT) * frame, wv = normalize(VIEW) * frame;
    DIFFUSE_LIGHT += material_brdf(wl, wv) * max(wl.z, 0.0) * ATTENUATION * LIGHT_COLOR;
}
"""


func replaced(text, pattern, by):
    var expression = RegEx.new()
    expression.compile(pattern)
    return expression.sub(text, by, true)


# The exported text in the language of Godot 3, which has no structures, macros and constants that are arrays: structures
# become vectors, and a constant becomes a function of the index.
func code_of(path):
    var file = File.new()
    file.open(path, File.READ)
    var text = replaced(file.get_as_text(), "(?m)^(#|precision|//).*$", "")
    text = replaced(text, "struct \\w+ {[^}]*};", "")
    text = text.replace("material_PmFeatures", "vec4").replace("features.x[", "features[")
    text = text.replace("features[k] = 0.0", "features = vec4(0.0)")
    text = text.replace("features[k]", "(k == 0 ? features.x : (k == 1 ? features.y : (k == 2 ? features.z : features.w)))")
    text = text.replace("material_AxialPsi", "vec2").replace("psi_.across", "psi_.x").replace("psi_.along", "psi_.y")
    text = replaced(text, "(material_variates|material_lobes)\\[([^\\]]*[a-z][^\\]]*)\\]", "$1($2)")
    return replaced(text, "const float (\\w+)\\[(\\d+)\\] = ([^;]*);", "float $1(int i) {\n    float table[$2] = $3;\n    return table[i];\n}")


func _initialize():
    var viewport = Viewport.new()
    viewport.size = Vector2(256, 256)
    viewport.own_world = true
    viewport.render_target_v_flip = true
    viewport.render_target_update_mode = Viewport.UPDATE_ALWAYS
    viewport.keep_3d_linear = true
    viewport.hdr = true
    root.add_child(viewport)
    var environment = WorldEnvironment.new()
    environment.environment = Environment.new()
    environment.environment.background_mode = Environment.BG_COLOR
    viewport.add_child(environment)
    var camera = Camera.new()
    camera.fov = 26
    camera.translation = Vector3(0, 0, 5)
    viewport.add_child(camera)
    var lamp = DirectionalLight.new()
    lamp.light_energy = 3 / PI  # with energy 1 a white diffuse surface that faces the lamp has radiance 1
    lamp.look_at_from_position(Vector3(-2, 2, 3), Vector3(0, 0, 0), Vector3(0, 1, 0))
    viewport.add_child(lamp)
    var ball = MeshInstance.new()
    ball.mesh = SphereMesh.new()
    ball.mesh.radial_segments = 256
    ball.mesh.rings = 128
    ball.material_override = ShaderMaterial.new()
    ball.material_override.shader = Shader.new()
    ball.material_override.shader.code = SHADER.replace("CODE", code_of("res://material.glsl"))
    viewport.add_child(ball)
    for i in 3:
        yield(self, "idle_frame")
    var image = viewport.get_texture().get_data()
    image.convert(Image.FORMAT_RGBAF)
    var file = File.new()
    file.open(OS.get_cmdline_args()[-1], File.WRITE)
    file.store_buffer(image.get_data())
    quit()
