!> The energy ledger: what the ground gave, what moves, what is stored, what was lost.
!>
!> Leap-frog conserves m v(n-1/2) v(n+1/2) / 2 plus the potential of linear springs and gravity exactly;
!> the residual is taken with this kinetic energy, so that it shows true gain or loss and not the
!> offset of half a step. Work is booked with the trapezoidal rule over each position step.
module dem_energy
   use common_kinds, only : wp
   use dem_law, only : elastic_energy
   use dem_model, only : block_model
   implicit none
   private
   public :: energy_terms, energy_now, energy_residual

   type :: energy_terms
      real(wp) :: kinetic = 0.0_wp        !! [J], at the time of the forces
      real(wp) :: leapfrog = 0.0_wp       !! [J], the conserved form
      real(wp) :: potential = 0.0_wp      !! of gravity, 0 at rest [J]
      real(wp) :: elastic = 0.0_wp        !! in the springs [J]
      real(wp) :: friction = 0.0_wp       !! lost by sliding and by breaking [J]
      real(wp) :: damping = 0.0_wp        !! lost in dashpots, or by impacts of rigid contacts [J]
      real(wp) :: mass_damping = 0.0_wp   !! lost by mass-proportional damping [J]
      real(wp) :: work = 0.0_wp           !! done by the ground and the supports [J]
   end type energy_terms

contains

   !> Energy that came from nowhere since the start [J]
   pure function energy_residual(energy, start) result(r)
      type(energy_terms), intent(in) :: energy
      type(energy_terms), intent(in) :: start
      real(wp) :: r
      r = (energy%leapfrog - start%leapfrog) + (energy%potential - start%potential) + (energy%elastic - start%elastic) &
         + (energy%friction - start%friction) + (energy%damping - start%damping) &
         + (energy%mass_damping - start%mass_damping) - (energy%work - start%work)
   end function energy_residual

   !> Ledger at the time of the last forces
   pure function energy_now(model) result(now)
      type(block_model), intent(in) :: model
      type(energy_terms) :: now
      integer :: k
      real(wp) :: vx, vy, spin, ax, ay, turn, cut, span

      ! The first step takes half a kick from the initial velocity; steps never grow after it.
      span = max(model%kick, model%step)
      cut = 0.5_wp * model%mass_damping * span
      do k = 1, size(model%set%item)
         associate (b => model%set%item(k))
            if (b%fixed) cycle
            ax = b%fx * b%inverse_mass + model%pull(1)
            ay = b%fy * b%inverse_mass + model%pull(2)
            turn = b%moment * b%inverse_inertia
            vx = (b%vx * (1.0_wp + cut) - span * ax) / (1.0_wp - cut)
            vy = (b%vy * (1.0_wp + cut) - span * ay) / (1.0_wp - cut)
            spin = (b%spin * (1.0_wp + cut) - span * turn) / (1.0_wp - cut)
            now%leapfrog = now%leapfrog + 0.5_wp * (b%mass * (b%vx * vx + b%vy * vy) + b%inertia * b%spin * spin)
            now%kinetic = now%kinetic + 0.125_wp * (b%mass * ((b%vx + vx - 2.0_wp * model%base(1))**2 &
               + (b%vy + vy - 2.0_wp * model%base(2))**2) + b%inertia * (b%spin + spin)**2)
            now%potential = now%potential - b%mass * (model%load%gravity(1) * (b%x - model%drift * b%vx - b%rest_x) &
               + model%load%gravity(2) * (b%y - model%drift * b%vy - b%rest_y))
            now%mass_damping = now%mass_damping + b%mass_loss
            now%work = now%work + b%work
         end associate
      end do
      now%friction = model%contacts%friction_loss
      now%damping = model%contacts%damping_loss
      now%work = now%work + model%contacts%support_work
      do k = 1, model%contacts%pairs
         associate (pair => model%contacts%pair(k))
            if (.not. model%rigid%used) now%elastic = now%elastic + elastic_energy(model%law(pair%law), pair)
            now%friction = now%friction + pair%loss_before(1) + sum(pair%point%friction_loss)
            now%damping = now%damping + pair%loss_before(2) + sum(pair%point%damping_loss)
            now%work = now%work + pair%support_work
         end associate
      end do
   end function energy_now

end module dem_energy
