"""A scene as MJCF, with its first state as a key frame."""

from scenes import Beyond, quaternion, rotation
import numpy as np

FLAGS = 'contact constraint equality frictionloss limit actuation clampctrl sensor'


def text(scene):
    links = scene['links']
    children = {-1: []}
    for i, link in enumerate(links):
        children.setdefault(link['parent'], []).append(i)
        children.setdefault(i, [])
    q, v, lines = [], [], []

    def numbers(values):
        return ' '.join(repr(float(x)) for x in values)

    def body(i):
        link = links[i]
        lines.append(f'<body name="b{i}" pos="{numbers(link["p"])}" quat="{numbers(quaternion(np.array(link["R"])))}">')
        for joint in link['joints']:
            lines.append(joint_text(link, joint))
        state(link)
        I = np.array(link['inertia'])
        full = [I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]]
        lines.append(f'<inertial pos="{numbers(link["com"])}" mass="{link["mass"]!r}" fullinertia="{numbers(full)}"/>')
        for child in children[i]:
            body(child)
        lines.append('</body>')

    def state(link):
        kind = link['joints'][0]['kind']
        if kind == 'FF':  # velocity of the origin in world axes first, then the angular velocity in the body's
            R = np.array(link['R'])
            q.extend(list(R @ link['q'][:3] + np.array(link['p'])) + list(quaternion(R @ rotation(link['q'][3:]))))
            v.extend(list(R @ rotation(link['q'][3:]) @ link['v'][3:]) + list(link['v'][:3]))
        else:
            q.extend(link['q'])
            v.extend(link['v'])

    for root in children[-1]:
        body(root)
    flags = ' '.join(f'{flag}="disable"' for flag in FLAGS.split())
    return '\n'.join(
        [
            f'<mujoco model="{scene["name"]}">',
            '<compiler angle="radian" balanceinertia="false" inertiafromgeom="false"/>',
            f'<option gravity="{numbers(scene["gravity"])}"><flag {flags}/></option>',
            '<worldbody>',
            *lines,
            '</worldbody>',
            f'<keyframe><key qpos="{numbers(q)}" qvel="{numbers(v)}"/></keyframe>',
            '</mujoco>',
        ]
    )


def joint_text(link, joint):
    kind = joint['kind']
    axis = ' '.join(repr(float(x)) for x in joint['axis'])
    more = f' stiffness="{link["stiffness"]!r}" damping="{link["damping"]!r}"'
    if kind == 'H':
        raise Beyond('MuJoCo has no screw joint')
    if link['spring'] == 'trace' and link['stiffness']:
        raise Beyond("MuJoCo's ball springs follow the angle, not its trace")
    if kind == 'FF':
        return '<freejoint/>'
    if kind == 'S':
        return f'<joint type="ball"{more}/>'
    return f'<joint type="{"hinge" if kind == "R" else "slide"}" axis="{axis}"{more}/>'
