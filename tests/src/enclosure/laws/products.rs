//! The products of a joint's kernels that the scene compiler takes for derivatives: residuals of their definitions, enclosed.

use super::super::grid::Grid;
use super::super::jet::Jet;
use super::{At, FIRST, Residual};
use hamel_codegen::derived::KernelKind;
use hamel_codegen::expr::Symbol;
use hamel_compiler::{JointType, Product};

impl At<'_> {
    /// The residuals of all products.
    pub fn products(mut self, joint: &JointType) -> Vec<Residual> {
        let arguments = &self.derived.arguments;
        let products = &joint.products;
        let near = self.moved(FIRST);
        let child = self.kernel_at(KernelKind::TwistMapChild, &near);
        let start = self.kernel(KernelKind::VelocityMap);
        let local = self.product(joint, &products.local_twist_map);
        self.equal("local_twist_map", &local, &child.values().times(&start));

        let map = child.times(&self.kernel_at(KernelKind::SpeedBasis, &near));
        let column = |symbols: &[Symbol]| {
            Grid::column(symbols.iter().map(|s| self.values.symbol(s)).collect())
        };
        let (speeds, wrench) = (column(&arguments.speeds), column(&arguments.wrench));
        let freedoms = self.freedoms();
        let each = |of: &dyn Fn(usize) -> Grid| {
            Grid::beside(&(0..freedoms).map(of).collect::<Vec<Grid>>())
        };
        let twists = each(&|i| map.slope(i).times(&speeds));
        let efforts = each(&|i| map.slope(i).transpose().times(&wrench));
        let bias = self.kernel_at(KernelKind::BiasAcceleration, &near);
        let biases = each(&|i| bias.slope(i));
        let of_twist = self.product(joint, &products.twist_gradient);
        self.equal("twist_gradient", &of_twist, &twists);
        let of_effort = self.product(joint, &products.effort_gradient);
        self.equal("effort_gradient", &of_effort, &efforts);
        let of_bias = self.product(joint, &products.bias_acceleration_gradient);
        self.equal("bias_acceleration_gradient", &of_bias, &biases);

        let of_bias = self.product(joint, &products.bias_acceleration_slope);
        let slopes = self.by_speeds(KernelKind::BiasAcceleration);
        self.equal("bias_acceleration_slope", &of_bias, &slopes);
        self.residuals
    }

    fn product(&self, joint: &JointType, product: &Product) -> Grid {
        let (rows, columns) = product.value.shape();
        Grid::new(rows, columns, self.values.program(joint.program(product)))
    }

    /// The derivatives of a kernel that is a column by each speed.
    fn by_speeds(&self, kind: KernelKind) -> Grid {
        let speeds = &self.derived.arguments.speeds;
        let count = speeds.len();
        let number = |s: &Symbol| self.values.symbol(s).value;
        let faster = speeds.iter().enumerate();
        let faster = faster.map(|(i, s)| Jet::variable(number(s), i, count, FIRST));
        let value = self.kernel_at(kind, &self.values.with(speeds, faster));
        Grid::beside(&(0..count).map(|i| value.slope(i)).collect::<Vec<Grid>>())
    }
}
