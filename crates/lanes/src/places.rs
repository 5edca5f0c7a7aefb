//! Rows are used again when nothing reads what they hold, so that all of them stay near the processor.

use crate::program::{Operand, Operation, Program};

/// Writes results at once where they are copied to at the end, one of the first `inputs`, if nothing reads afterwards what stood there.
pub fn in_place(operations: &mut Vec<Operation>, inputs: usize) {
    for number in (0..operations.len()).rev() {
        let Operation::Copy(Operand::Row(result), place) = operations[number] else {
            continue;
        };
        let is_result = |own: &Operation| own.written().contains(&result);
        let Some(writer) = operations.iter().position(is_result) else {
            continue;
        };
        let copies =
            |own: &Operation| matches!(own, Operation::Copy(Operand::Row(of), _) if *of == result);
        let after = &operations[writer + 1..];
        let is_free = (place as usize) < inputs
            && !after.iter().any(|own| own.read().contains(&place))
            && after.iter().filter(|own| copies(own)).count() == 1;
        if is_free {
            operations.remove(number);
            for own in &mut operations[writer..] {
                own.rename(&mut |row| if row == result { place } else { row });
            }
        }
    }
}

/// The program on fewer rows. The first `inputs` stay, and so do those that are computed once and read in steps.
pub fn shared(mut program: Program, inputs: usize) -> Program {
    let mut next = inputs as u32;
    let mut place: Vec<Option<u32>> = (0..program.rows as u32)
        .map(|row| (row < next).then_some(row))
        .collect();
    let mut is_kept = vec![false; program.rows];
    for operation in &program.step {
        for row in operation.read() {
            is_kept[row as usize] = true;
        }
    }
    let written: Vec<u32> = program.once.iter().flat_map(Operation::written).collect();
    let kept = written.into_iter().filter(|row| is_kept[*row as usize]);
    for row in kept {
        place[row as usize] = Some(next);
        next += 1;
    }
    let most = [&mut program.once, &mut program.step]
        .map(|operations| compact(operations, &mut place, next))
        .into_iter()
        .fold(next, u32::max);
    program.rows = most as usize;
    program
}

/// Gives places to rows that have none, from `first` on; how many places there are then.
fn compact(operations: &mut [Operation], place: &mut [Option<u32>], first: u32) -> u32 {
    let mut last = vec![usize::MAX; place.len()];
    for (number, operation) in operations.iter().enumerate() {
        for row in operation.read().into_iter().chain(operation.written()) {
            last[row as usize] = number;
        }
    }
    let (mut free, mut end): (Vec<u32>, u32) = (vec![], first);
    for (number, operation) in operations.iter_mut().enumerate() {
        let mut done: Vec<u32> = vec![];
        operation.rename(&mut |row| {
            let found = place[row as usize];
            let own = found.unwrap_or_else(|| {
                free.pop().unwrap_or_else(|| {
                    end += 1;
                    end - 1
                })
            });
            place[row as usize] = Some(own);
            if own >= first && last[row as usize] == number && !done.contains(&own) {
                done.push(own);
            }
            own
        });
        // Behind the operation: it may read its operands while it writes.
        free.extend(done);
    }
    end
}
