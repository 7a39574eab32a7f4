"""Blocks in plain pymunk: friction of a joint is a pivot on the ground, of bounded force and without a bias."""

import pymunk
from blocks import run


def joint(block, options):
    space = pymunk.Space()
    body = pymunk.Body(block.mass, float("inf"))
    body.velocity = (block.velocity, 0)
    space.add(body, pymunk.GrooveJoint(space.static_body, body, (-99, 0), (99, 0), (0, 0)))
    rub = pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0))
    rub.max_bias = 0
    space.add(rub)
    for step in range(block.steps):
        rub.max_force = block.friction * block.normal(step)
        body.apply_force_at_world_point((block.pull(step), 0), body.position)
        space.step(block.step)
        yield body.position.x, body.velocity.x


def contact(block, options):
    space = pymunk.Space()
    space.gravity = (0, -block.gravity)
    ground = pymunk.Segment(space.static_body, (-99, -1), (99, -1), 1)
    body = pymunk.Body(block.mass, pymunk.moment_for_box(block.mass, (0.2, 0.2)))
    body.position = (0, 0.1)
    box = pymunk.Poly.create_box(body, (0.2, 0.2))
    box.friction, ground.friction = block.friction, 1.0
    space.add(body, box, ground)
    begin = 0.0
    for step in range(-block.settling, block.steps):
        if step == 0:
            begin = body.position.x
            body.velocity = (block.velocity, body.velocity.y)
        body.apply_force_at_world_point(block.forces(step), body.position)
        space.step(block.step)
        if step >= 0:
            yield body.position.x - begin, body.velocity.x


run({"joint": joint, "contact": contact})
