//! Fusing of products into sums, removal of dead code, and an order of instructions with a small
//! live set.

use super::instruction::{Instruction, Op, Operand, Tape};
use super::lower::Builder;

/// Fuses, orders and renumbers the instructions that the outputs need.
pub(crate) fn finish(builder: &mut Builder, outputs: Vec<(u32, Operand)>) -> Tape {
    fuse(builder, &outputs);
    order(&builder.instructions, outputs)
}

fn count_uses(instructions: &[Instruction], outputs: &[(u32, Operand)]) -> Vec<u32> {
    let mut uses = vec![0; instructions.len()];
    let mut live: Vec<bool> = vec![false; instructions.len()];
    for &(_, operand) in outputs {
        if let Operand::Temporary(k) = operand {
            uses[k as usize] += 1;
            live[k as usize] = true;
        }
    }
    for (k, instruction) in instructions.iter().enumerate().rev() {
        if live[k] {
            for operand in instruction.operands() {
                if let Operand::Temporary(j) = *operand {
                    uses[j as usize] += 1;
                    live[j as usize] = true;
                }
            }
        }
    }
    uses
}

/// Merges a product that is used once into the sum that uses it.
fn fuse(builder: &mut Builder, outputs: &[(u32, Operand)]) {
    let uses = count_uses(&builder.instructions, outputs);
    for k in 0..builder.instructions.len() {
        let instruction = builder.instructions[k];
        let [a, b, ..] = instruction.args;
        let product = |operand: Operand, op: Op| match operand {
            Operand::Temporary(j) if uses[j as usize] == 1 => {
                let instruction = builder.instructions[j as usize];
                (instruction.op == op).then_some((instruction.args[0], instruction.args[1]))
            }
            _ => None,
        };
        let fused = match instruction.op {
            Op::Add => match (product(a, Op::Mul), product(b, Op::Mul)) {
                (Some((p, q)), Some((r, s))) => Some(Instruction::new(Op::MulMulAdd, &[p, q, r, s])),
                (Some((p, q)), None) => Some(Instruction::new(Op::MulAdd, &[p, q, b])),
                (None, Some((p, q))) => Some(Instruction::new(Op::MulAdd, &[p, q, a])),
                (None, None) => match (product(a, Op::MulReal), product(b, Op::MulReal)) {
                    (_, Some((p, r))) => Some(Instruction::new(Op::MulRealAdd, &[p, r, a])),
                    (Some((p, r)), None) => Some(Instruction::new(Op::MulRealAdd, &[p, r, b])),
                    (None, None) => None,
                },
            },
            Op::Sub => match (product(a, Op::Mul), product(b, Op::Mul)) {
                (Some((p, q)), Some((r, s))) => Some(Instruction::new(Op::MulMulSub, &[p, q, r, s])),
                (Some((p, q)), None) => Some(Instruction::new(Op::MulSub, &[p, q, b])),
                (None, Some((p, q))) => Some(Instruction::new(Op::SubMul, &[p, q, a])),
                (None, None) => product(b, Op::MulReal).map(|(p, r)| {
                    let Operand::Constant(c) = r else { unreachable!("MulReal takes a constant") };
                    let negative = -builder.constants[c as usize].clone();
                    let negative = builder.constant(negative);
                    Instruction::new(Op::MulRealAdd, &[p, negative, a])
                }),
            },
            _ => None,
        };
        if let Some(fused) = fused {
            builder.instructions[k] = fused;
        }
    }
}

/// Depth-first from the outputs: every value is computed shortly before its first use.
fn order(instructions: &[Instruction], outputs: Vec<(u32, Operand)>) -> Tape {
    const UNSEEN: u32 = u32::MAX;
    let weight = weights(instructions);
    let mut position = vec![UNSEEN; instructions.len()];
    let mut tape = Tape::default();
    let mut stack: Vec<(u32, bool)> = Vec::new();
    for &(_, output) in &outputs {
        if let Operand::Temporary(k) = output {
            stack.push((k, false));
        }
        while let Some((k, ready)) = stack.pop() {
            if position[k as usize] != UNSEEN {
                continue;
            }
            let mut instruction = instructions[k as usize];
            if ready {
                for operand in &mut instruction.args {
                    *operand = renumber(*operand, &position);
                }
                position[k as usize] = tape.instructions.len() as u32;
                tape.instructions.push(instruction);
                continue;
            }
            stack.push((k, true));
            // The operand that needs most room comes first, so it is pushed last.
            let mut operands: Vec<u32> = instruction
                .operands()
                .iter()
                .filter_map(|operand| match operand {
                    Operand::Temporary(j) if position[*j as usize] == UNSEEN => Some(*j),
                    _ => None,
                })
                .collect();
            operands.sort_by_key(|&j| (weight[j as usize], std::cmp::Reverse(j)));
            stack.extend(operands.into_iter().map(|j| (j, false)));
        }
    }
    tape.outputs = outputs.into_iter().map(|(slot, operand)| (slot, renumber(operand, &position))).collect();
    tape
}

fn renumber(operand: Operand, position: &[u32]) -> Operand {
    match operand {
        Operand::Temporary(k) => Operand::Temporary(position[k as usize]),
        other => other,
    }
}

/// Registers that each value would need if the program were a tree (Sethi and Ullman 1970).
fn weights(instructions: &[Instruction]) -> Vec<u32> {
    let mut weight: Vec<u32> = Vec::with_capacity(instructions.len());
    for instruction in instructions {
        let mut needs: Vec<u32> = instruction
            .operands()
            .iter()
            .filter_map(|operand| match operand {
                Operand::Temporary(j) => Some(weight[*j as usize]),
                _ => None,
            })
            .collect();
        needs.sort_unstable_by(|a, b| b.cmp(a));
        weight.push(needs.iter().zip(0u32..).map(|(w, k)| w.saturating_add(k)).max().unwrap_or(0).max(1));
    }
    weight
}
